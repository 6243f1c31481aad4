// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/parts.h"
#include "bench/speed/families.h"
#include "bench/speed/searcher.h"
#include "bench/speed/stopwatch.h"
#include "keepout/error.h"
#include "keepout/fixtures/poses.h"

namespace keepout::app {
namespace {

struct Rival {
  std::string_view index;
  std::string_view name;
  double least;  // how many times as long as ours it must take
};

constexpr std::array rivals{Rival{"fcl_obbrss", "FCL's tree", 15.0},
                            Rival{"embree", "Embree", 3.0}};

MeasuredSide time_build(const SpeedRun& run, const IndexedMesh& on, std::string name,
                        unsigned threads) {
  return timed_whole(std::move(name), run.settings.effort.builds,
                     [&] { const WideBvh index(on.mesh, threads); });
}

void measure_builds(SpeedRun& run, const IndexedMesh& on) {
  const MeasuredSide ours = time_build(run, on, "wide_bvh", 1);
  MeasuredSide on_two_cores;
  {
    const Pinned::Released released(run.pinned, 2);
    on_two_cores = time_build(run, on, "wide_bvh, 2 cores", 2);
  }
  for (const Rival& rival : rivals) {
    std::optional<MeasuredSide> theirs;
    std::string remark;
    try {
      const IndexBackend& backend = entry_named(rival.index, indices(), "index", absent_indices());
      theirs = timed_whole(std::string(rival.name), 1, [&] { backend.make(on.mesh); });
    } catch (const Error& error) {
      remark = error.what();
    }
    SpeedRow row = ratio("build of the index", std::string(rival.name) + " / wide_bvh",
                         at_least(rival.least), theirs, ours);
    row.sides.push_back(on_two_cores);
    row.remark = remark;
    run.add(std::move(row));
  }
}

/// The surface as it breathes: every vertex is elsewhere, and neighbours stay neighbours.
std::shared_ptr<const Mesh> deformed(const Mesh& mesh) {
  Surface surface{{mesh.vertices().begin(), mesh.vertices().end()},
                  {mesh.triangles().begin(), mesh.triangles().end()}};
  for (Vec3& vertex : surface.vertices) {
    constexpr double amplitude = 0.5, wavelength = 30.0;  // [mm]
    vertex.z() += amplitude * (1.5 + std::sin(vertex.x() * 2.0 * std::numbers::pi / wavelength));
  }
  return std::make_shared<const Mesh>(in_single_precision(std::move(surface)));
}

void measure_refit(SpeedRun& run, const IndexedMesh& on) {
  const std::shared_ptr<const Mesh> moved = deformed(*on.mesh);
  WideBvh index(on.mesh, 1);
  // There and back, so that each time all have moved.
  bool is_moved = false;
  const MeasuredSide refit = timed_whole("refit", 2 * run.settings.effort.builds + 1, [&] {
    index.refit(is_moved ? on.mesh : moved, 1);
    is_moved = !is_moved;
  });
  Random random = run.random();
  const std::vector<Vec3> places = surface_points(*moved, 8, 1.0, random);
  const Question held_to_brute_force(moved, index, 2.0, places);
  run.add(ratio("refit after all vertices moved, one core", "refit / build", at_most(0.1), refit,
                time_build(run, on, "build", 1)));
}

void measure_memory(SpeedRun& run, const IndexedMesh& on) {
  const auto triangles = static_cast<double>(on.mesh->triangle_count());
  const double index = static_cast<double>(on.index->memory()) / triangles;
  const double mesh = static_cast<double>(on.mesh->vertex_count() * sizeof(Vec3) +
                                          on.mesh->triangle_count() * sizeof(Corners)) /
                      triangles;
  run.add({.work = "memory, a triangle",
           .compared = "index",
           .demand = at_most(45.0),
           .unit = "bytes",
           .figure = index});
  run.add({.work = "memory, a triangle",
           .compared = "index and mesh",
           .demand = at_most(100.0),
           .unit = "bytes",
           .figure = index + mesh});
}

}  // namespace

void measure_index_costs(SpeedRun& run, const IndexedMesh& on) {
  run.show("index builds");
  measure_builds(run, on);
  measure_refit(run, on);
  measure_memory(run, on);
}

}  // namespace keepout::app
