// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <system_error>
#include <utility>

#include "bench/speed/speed.h"
#include "compare/subject.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/index/index_cache.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/mesh/load_mesh.h"
#include "shared/machine.h"
#include "shared/number_text.h"

#if KEEPOUT_WITH_ASSIMP
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

namespace keepout::app {
namespace {

MeasuredSide time_build(const SpeedRun& run, const IndexedMesh& on, std::string name,
                        unsigned threads) {
  const OnCores cores(threads);
  return timed_whole(std::move(name), run.effort.builds,
                     [&] { const WideBvh index(on.mesh, threads); });
}

void measure_builds(SpeedRun& run, const IndexedMesh& on) {
  const MeasuredSide ours = time_build(run, on, "wide_bvh", 1);
  const MeasuredSide on_two_cores = time_build(run, on, "wide_bvh, 2 cores", 2);
  for (const Rival& rival : rivals) {
    const std::string name(rival.name);
    const MeasuredSide theirs =
        attempted(name, [&] { return index_backends().named(rival.index).make(on.mesh); });
    SpeedRow row =
        ratio("build of the index", name + " / wide_bvh", at_least(rival.build), theirs, ours);
    row.sides.push_back(on_two_cores);
    run.add(std::move(row));
  }
}

/// Returns the surface deformed as by breathing: every vertex moves, and neighbors stay neighbors.
std::shared_ptr<const Mesh> deformed(const Mesh& mesh) {
  Surface surface = surface_of(mesh);
  for (Vec3& vertex : surface.vertices) {
    constexpr double amplitude = 0.5, wavelength = 30.0;  // [mm]
    vertex.z() += amplitude * (1.5 + std::sin(vertex.x() * 2.0 * std::numbers::pi / wavelength));
  }
  return std::make_shared<const Mesh>(in_single_precision(std::move(surface)));
}

void measure_refit(SpeedRun& run, const IndexedMesh& on) {
  const std::shared_ptr<const Mesh> moved = deformed(*on.mesh);
  const auto index = std::make_shared<WideBvh>(on.mesh, 1);
  // There and back, so that all vertices move each time.
  bool is_moved = false;
  const MeasuredSide refit = timed_whole("refit", 2 * run.effort.builds + 1, [&] {
    index->refit(is_moved ? on.mesh : moved, 1);
    is_moved = !is_moved;
  });
  hold_to_brute_force({moved, index}, run.random());
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

/// A loaded mesh.
struct Loaded {
  IndexedMesh mesh;
  MeasuredSide time;      // from the file to the index, on two cores
  double peak_gib = 0.0;  // of memory during loading
};

Loaded load(SpeedRun& run, std::size_t triangles) {
  const std::string name = counted(triangles, "triangle");
  run.show("making a mesh of " + name);
  const std::filesystem::path file = large_bunny(triangles);
  run.show("loading " + name);
  Loaded loaded;
  reset_peak_memory();
  const OnCores two(2);
  loaded.time = timed_whole(name, 1, [&] { loaded.mesh = with_index(load_mesh(file).mesh); });
  loaded.peak_gib = static_cast<double>(peak_memory()) / static_cast<double>(1 << 30);
  return loaded;
}

std::string millions(std::size_t triangles) {
  return triangles < 1'000'000 ? grouped(triangles)
                               : rounded(1e-6 * static_cast<double>(triangles), 2) + " M";
}

/// Adds the usual steps in contact, compared with those on the mesh of all other rows.
void add_contact(SpeedRun& run, const IndexedMesh& on, std::size_t triangles, double most) {
  MeasuredSide contact = in_contact(run, on);
  contact.name = millions(triangles) + " triangles";
  run.add(ratio("certified in contact, margin .2 mm",
                millions(triangles) + " / " + millions(run.triangles) + " triangles", at_most(most),
                contact, run.contact_side));
}

/// Adds large steps over a fine mesh, in µs.
void add_large_steps(SpeedRun& run, const IndexedMesh& on, std::size_t triangles) {
  const MeasuredSide side =
      in_contact(run, on, {.clearance = 1.1, .shortest = 1.0, .longest = 5.0});
  SpeedRow row{
      .work = "certified, motion 1-5 mm, margin 1.1 mm, " + millions(triangles) + " triangles",
      .compared = "median",
      .demand = at_most(20.0),
      .unit = "us",
      .remark = side.refusal,
      .is_wrong = side.is_wrong};
  if (side.refusal.empty()) {
    row.figure = side.us.p50;
    row.sides = {side};
  }
  run.add(row);
  row.compared = "p99.9";
  row.demand = at_most(40.0);
  if (side.refusal.empty()) row.figure = side.us.p999;
  run.add(std::move(row));
}

constexpr unsigned cores = 2;

/// Reads a mesh file as a program with assimp alone would: triangulated, and not welded, which is
/// fastest. Throws Error, also in a build without assimp.
Surface assimp_surface([[maybe_unused]] const std::filesystem::path& file) {
#if KEEPOUT_WITH_ASSIMP
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (scene == nullptr) throw Error(file.string() + ": assimp: " + importer.GetErrorString());
  Surface surface;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    const auto first = static_cast<VertexId>(surface.vertices.size());
    surface.vertices.reserve(first + mesh.mNumVertices);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& at = mesh.mVertices[v];
      surface.vertices.emplace_back(double{at.x}, double{at.y}, double{at.z});
    }
    surface.triangles.reserve(surface.triangles.size() + mesh.mNumFaces);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      surface.triangles.push_back(
          {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
  }
  return surface;
#else
  throw Error("this build has no assimp: configure with KEEPOUT_WITH_ASSIMP=ON");
#endif
}

/// Does what a program does at its start; reads the index from its cache if there is one.
void first_step(const std::filesystem::path& file, const std::filesystem::path& cache = {}) {
  const std::shared_ptr<const Mesh> mesh = load_mesh(file).mesh;
  const std::shared_ptr<const SpatialIndex> index =
      cache.empty() ? std::make_unique<WideBvh>(mesh, cores) : load_or_build(mesh, cache);
  MotionConstraint constraint =
      make_motion_constraint(mesh, index, {.inside = Inside::taken_as_is});
  const Step step = constraint.step({.tip = mesh->bounds().high, .desired = Vec3(0.1, 0.1, 0.1)});
  if (!step.ok()) throw Error("the first step failed: " + std::string(step.reason()));
}

}  // namespace

void measure_index_costs(SpeedRun& run) {
  const IndexedMesh& on = run.bunny;
  run.show("index builds");
  measure_builds(run, on);
  measure_refit(run, on);
  measure_memory(run, on);
}

void measure_large_meshes(SpeedRun& run) {
  const std::size_t triangles = 16 * run.triangles;
  MeasuredSide time;
  {
    const Loaded large = load(run, triangles);
    time = large.time;
    add_contact(run, large.mesh, triangles, 3.0);
    add_large_steps(run, large.mesh, triangles);
  }
  if (!run.options.speed.largest) return;
  const std::size_t most = *run.options.speed.largest;
  const Loaded largest = load(run, most);
  run.add(ratio("file to index, 2 cores", millions(most) + " / " + time.name, at_most(7.0),
                largest.time, time));
  run.add({.work = "file to index, " + millions(most) + " triangles",
           .compared = "peak of memory",
           .demand = at_most(14.0),
           .unit = "GiB",
           .figure = largest.peak_gib});
  add_contact(run, largest.mesh, most, 6.0);
}

void measure_first_step(SpeedRun& run) {
  run.show("from a file to the first step");
  const std::filesystem::path file = fixture_path(run.effort.file);
  const OnCores two(cores);
  const std::size_t count =
      load_mesh(file).mesh->triangle_count();  // loads the file into the page cache
  const std::string work = "binary STL, " + counted(count, "triangle") + ", to first step, 2 cores";
  const MeasuredSide theirs = attempted("assimp + FCL OBBRSS", [&] {
    const auto mesh = std::make_shared<const Mesh>(assimp_surface(file));
    const auto fcl = index_backends().named("fcl_obbrss").make(mesh);
  });
  const MeasuredSide mine = timed_whole("ours", run.effort.builds, [&] { first_step(file); });
  run.add(ratio(work, "(assimp + FCL's tree) / ours", at_least(8.0), theirs, mine));

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("keepout-speed-" + std::to_string(getpid()));
  const std::shared_ptr<void> removal(nullptr, [&](void*) {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  });
  first_step(file, folder);  // builds the index and caches it
  const MeasuredSide with_cache = timed_whole("ours, index from the cache", run.effort.builds,
                                              [&] { first_step(file, folder); });
  run.add(ratio(work, "(assimp + FCL's tree) / ours, with the index cache", at_least(50.0), theirs,
                with_cache));
}

}  // namespace keepout::app
