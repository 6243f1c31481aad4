// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "bench/parts.h"
#include "bench/speed/assimp_file.h"
#include "bench/speed/families.h"
#include "bench/speed/stopwatch.h"
#include "keepout/activation/registry.h"
#include "keepout/error.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/index/index_cache.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/solvers/active_set.h"
#include "keepout/step/motion_constraint.h"
#include "number_text.h"

namespace keepout::app {
namespace {

constexpr unsigned cores = 2;

void first_step(std::shared_ptr<const Mesh> mesh, std::unique_ptr<SpatialIndex> index) {
  const Vec3 tip = mesh->bounds().high;
  MotionConstraint constraint(mesh, std::move(index), make_activation("certified", mesh),
                              std::make_unique<ActiveSet>(), {.radius = 5.0, .margin = 0.2});
  const Step step = constraint.step({.tip = tip, .desired = Vec3(0.1, 0.1, 0.1)});
  if (!step.ok()) throw Error("the first step failed: " + std::string(step.reason()));
}

void ours(const std::filesystem::path& file) {
  const std::shared_ptr<const Mesh> mesh = load_mesh(file).mesh;
  first_step(mesh, std::make_unique<WideBvh>(mesh, cores));
}

/// The same, the index read from its cache if it is there.
void cached(const std::filesystem::path& file, const std::filesystem::path& folder) {
  const std::shared_ptr<const Mesh> mesh = load_mesh(file).mesh;
  first_step(mesh, load_or_build(mesh, folder));
}

/// A folder for indices that goes away with this object.
class CacheFolder {
 public:
  CacheFolder()
      : path_(std::filesystem::temp_directory_path() /
              ("keepout-speed-" + std::to_string(getpid()))) {}
  ~CacheFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  CacheFolder(const CacheFolder&) = delete;
  CacheFolder& operator=(const CacheFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Assimp reads, FCL builds; nothing is welded.
std::optional<MeasuredSide> libraries(const std::filesystem::path& file, std::string& remark) {
  try {
    return timed_whole("assimp + FCL OBBRSS", 1, [&] {
      const auto mesh = std::make_shared<const Mesh>(assimp_surface(file));
      const auto fcl = entry_named("fcl_obbrss", indices(), "index", absent_indices()).make(mesh);
    });
  } catch (const Error& error) {
    remark = error.what();
    return std::nullopt;
  }
}

}  // namespace

void measure_first_step(SpeedRun& run) {
  const std::string fixture = run.settings.file;
  run.show("from a file to the first step");
  const std::filesystem::path file = fixture_path(fixture);
  const Pinned::Released released(run.pinned, cores);
  const std::size_t count = load_mesh(file).mesh->triangle_count();  // and the file is in memory
  const std::string work = "binary STL, " + counted(count, "triangle") + ", to first step, 2 cores";
  std::string remark;
  const std::optional<MeasuredSide> theirs = libraries(file, remark);
  const MeasuredSide mine = timed_whole("ours", run.settings.effort.builds, [&] { ours(file); });
  SpeedRow row = ratio(work, "(assimp + FCL's tree) / ours", at_least(8.0), theirs, mine);
  row.remark = remark;
  run.add(std::move(row));

  const CacheFolder folder;
  cached(file, folder.path());  // builds the index, and puts it there
  const MeasuredSide with_cache =
      timed_whole("ours, index from the cache", run.settings.effort.builds,
                  [&] { cached(file, folder.path()); });
  row = ratio(work, "(assimp + FCL's tree) / ours, with the index cache", at_least(50.0), theirs,
              with_cache);
  row.remark = remark;
  run.add(std::move(row));
}

}  // namespace keepout::app
