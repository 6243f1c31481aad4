// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>
#include <utility>

#include "bench/speed/certified_contact.h"
#include "bench/speed/families.h"
#include "bench/speed/peak_memory.h"
#include "bench/speed/stopwatch.h"
#include "keepout/mesh/load_mesh.h"
#include "number_text.h"

namespace keepout::app {
namespace {

constexpr double gibibyte = 1 << 30;

struct Loaded {
  IndexedMesh mesh;
  MeasuredSide time;      // from the file to the index, on two cores
  double peak_gib = 0.0;  // of memory meanwhile
};

Loaded load(SpeedRun& run, std::size_t triangles) {
  const std::string name = counted(triangles, "triangle");
  run.show("making a mesh of " + name);
  const std::filesystem::path file = large_bunny(triangles);
  run.show("loading " + name);
  Loaded loaded;
  reset_peak_memory();
  const Pinned::Released released(run.pinned, 2);
  loaded.time = timed_whole(name, 1, [&] { loaded.mesh = with_index(load_mesh(file).mesh); });
  loaded.peak_gib = static_cast<double>(peak_memory()) / gibibyte;
  return loaded;
}

std::string millions(std::size_t triangles) {
  return triangles < 1'000'000 ? grouped(triangles)
                               : rounded(1e-6 * static_cast<double>(triangles), 2) + " M";
}

/// The usual contact, beside that on the mesh of all other rows.
void add_contact(SpeedRun& run, const IndexedMesh& on, std::size_t triangles, double most) {
  CertifiedSide side = in_contact(run, on, {});
  if (side.side) side.side->name = millions(triangles) + " triangles";
  run.add(with_remark(
      ratio("certified in contact, margin .2 mm",
            millions(triangles) + " / " + millions(run.settings.triangles) + " triangles",
            at_most(most), side.side, run.baselines.contact),
      side));
}

/// Large steps over a fine mesh, in microseconds.
void add_large_steps(SpeedRun& run, const IndexedMesh& on, std::size_t triangles) {
  const CertifiedSide side = in_contact(run, on, {.margin = 1.1, .shortest = 1.0, .longest = 5.0});
  const std::string work =
      "certified, motion 1-5 mm, margin 1.1 mm, " + millions(triangles) + " triangles";
  SpeedRow median{.work = work, .compared = "median", .demand = at_most(20.0), .unit = "us"};
  SpeedRow tail{.work = work, .compared = "p99.9", .demand = at_most(40.0), .unit = "us"};
  if (side.side) {
    median.figure = side.side->us.p50;
    tail.figure = side.side->us.p999;
    median.sides = tail.sides = {*side.side};
  }
  run.add(with_remark(std::move(median), side));
  run.add(with_remark(std::move(tail), side));
}

void measure_largest(SpeedRun& run, std::size_t triangles, const MeasuredSide& smaller) {
  const Loaded largest = load(run, triangles);
  run.add(ratio("file to index, 2 cores", millions(triangles) + " / " + smaller.name, at_most(7.0),
                largest.time, smaller));
  run.add({.work = "file to index, " + millions(triangles) + " triangles",
           .compared = "peak of memory",
           .demand = at_most(14.0),
           .unit = "GiB",
           .figure = largest.peak_gib});
  add_contact(run, largest.mesh, triangles, 6.0);
}

}  // namespace

void measure_large_meshes(SpeedRun& run) {
  const std::size_t triangles = run.settings.larger * run.settings.triangles;
  MeasuredSide time;
  {
    const Loaded large = load(run, triangles);
    time = large.time;
    add_contact(run, large.mesh, triangles, 3.0);
    add_large_steps(run, large.mesh, triangles);
  }
  if (run.settings.largest) measure_largest(run, *run.settings.largest, time);
}

}  // namespace keepout::app
