// SPDX-License-Identifier: BSD-3-Clause
#include "compare/subject.h"

#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "keepout/fixtures/resample_mesh.h"
#include "shared/named_mesh.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

/// Returns the processor time of all threads of this process. [s]
double own_time() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Returns the busy time of all cores since the machine started. [s]
std::optional<double> all_time() {
  std::ifstream file("/proc/stat");
  std::string name;
  double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, hard = 0, soft = 0, stolen = 0;
  if (!(file >> name >> user >> nice >> system >> idle >> waiting >> hard >> soft >> stolen)) {
    return std::nullopt;
  }
  const double busy = user + nice + system + hard + soft + stolen;
  if (name != "cpu" || busy <= 0.0) return std::nullopt;
  return busy / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

}  // namespace

UsedCores::UsedCores()
    : start_(std::chrono::steady_clock::now()), own_start_(own_time()), all_start_(all_time()) {}

double UsedCores::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double UsedCores::own() const { return (own_time() - own_start_) / seconds(); }

std::optional<double> UsedCores::others() const {
  const std::optional<double> all = all_time();
  if (!all || !all_start_) return std::nullopt;
  // The system counts in hundredths of a second, so the difference may be negative.
  return std::max(0.0, (*all - *all_start_ - (own_time() - own_start_)) / seconds());
}

std::string label_of(const Subject& subject) {
  return std::filesystem::path(subject.mesh).filename().string();
}

std::string title_of(const Subject& subject) {
  if (subject.triangles == 0) return label_of(subject);
  return subject.mesh + ", " + counted(subject.triangles, "triangle");
}

LoadedSubject load(const Subject& subject) {
  const UsedCores used;
  LoadedSubject loaded{
      .mesh = load_named_mesh(subject.mesh, subject.load).mesh, .seconds = 0.0, .cores = 0.0};
  loaded.seconds = used.seconds();
  loaded.cores = used.own();
  if (subject.triangles == 0) return loaded;
  std::shared_ptr<const Mesh>& mesh = loaded.mesh;
  constexpr double largest_extent = 150.0;  // [mm]
  Surface bunny = surface_of(*mesh);
  mesh.reset();
  constexpr std::uint64_t seed = 1;
  mesh = std::make_shared<const Mesh>(
      resampled(scaled(std::move(bunny), largest_extent), subject.triangles, seed));
  return loaded;
}

std::shared_ptr<const Mesh> make_mesh(const Subject& subject) { return load(subject).mesh; }

Surface surface_of(const Mesh& mesh) {
  return {{mesh.vertices().begin(), mesh.vertices().end()},
          {mesh.triangles().begin(), mesh.triangles().end()}};
}

}  // namespace keepout::app
