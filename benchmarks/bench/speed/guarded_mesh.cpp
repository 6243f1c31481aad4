// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/guarded_mesh.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "bench/bench.h"
#include "compare/subject.h"
#include "keepout/error.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/queries_only.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/fixtures/resample_mesh.h"
#include "keepout/index/query.h"
#include "keepout/index/wide_bvh.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

/// Capacity for the triangles within 5 mm anywhere on these meshes.
constexpr Capacity room{.triangles = std::size_t{1} << 17,
                        .planes = std::size_t{1} << 16,
                        .variables = 3,
                        .extra_rows = 0};

Surface resampled_bunny(std::size_t triangles) {
  return surface_of(*make_mesh({std::string(resampled_mesh), triangles}));
}

/// Returns half of the sample in a row, as a loop would step, and half from everywhere.
std::vector<Motion> sample_of(std::span<const Motion> motions) {
  constexpr std::size_t most_samples = 500;
  const std::size_t in_a_row = std::min(most_samples / 2, motions.size());
  std::vector<Motion> sample(motions.begin(), motions.begin() + in_a_row);
  for (std::size_t s = 0; s < in_a_row; ++s) {
    sample.push_back(motions[s * motions.size() / in_a_row]);
  }
  return sample;
}

constexpr int most_rounds = 50;  // about ten are enough if most tips have enough space

Vec3 somewhere_free(const Mesh& mesh, NearestTriangle& nearest, const FreeSpace& space,
                    Random& random) {
  constexpr std::size_t most_tries = 1000;
  const double middle = 0.5 * (space.nearest + space.farthest);
  for (const Vec3& tip : surface_points(mesh, most_tries, middle, random)) {
    const double distance = nearest(tip, middle).closest.distance;
    if (distance > space.nearest && distance < space.farthest) return tip;
  }
  throw Error("the mesh has hardly any free space around it; is it in another unit?");
}

}  // namespace

IndexedMesh with_index(std::shared_ptr<const Mesh> mesh) {
  auto index = std::make_shared<const WideBvh>(mesh);
  return {std::move(mesh), std::move(index)};
}

IndexedMesh queried(const IndexedMesh& on) {
  return {on.mesh, std::make_shared<const QueriesOnly>(on.index)};
}

Surface in_single_precision(Surface surface) {
  for (Vec3& vertex : surface.vertices) vertex = vertex.cast<float>().cast<double>().eval();
  return surface;
}

std::shared_ptr<const Mesh> bunny_of(std::size_t triangles) {
  return std::make_shared<const Mesh>(in_single_precision(resampled_bunny(triangles)));
}

std::filesystem::path large_bunny(std::size_t triangles) {
  const std::filesystem::path folder = fixture_cache() / "made";
  std::filesystem::path file = folder / ("bunny_" + std::to_string(triangles) + ".stl");
  if (std::filesystem::exists(file)) return file;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(folder.string() + ": cannot be made: " + error.message());
  constexpr std::uint64_t seed = 2;
  write_subdivided(file, resampled_bunny(triangles / 4), seed);
  return file;
}

MotionConstraint certified(const IndexedMesh& on, double margin) {
  return make_motion_constraint(on.mesh, on.index,
                                {.activation = "certified",
                                 .options = {.radius = 5.0, .margin = margin},
                                 .inside = Inside::taken_as_is,
                                 .capacity = room});
}

MotionConstraint paper(const IndexedMesh& on, double radius, const std::string& solver) {
  return make_motion_constraint(on.mesh, on.index,
                                {.activation = "paper",
                                 .solver = solver,
                                 .options = {.radius = radius, .margin = 0.0},
                                 .capacity = room});
}

std::string disagreement(MotionConstraint& one, MotionConstraint& other,
                         std::span<const Motion> motions, double accuracy) {
  const auto differ = [&](const Motion& motion) {
    const Answer a = one.step(motion), b = other.step(motion);
    if (accuracy == 0.0) return a != b;
    if (!is_ok(a.status) || !is_ok(b.status)) return false;  // a solver may give up
    return !((a.motion - b.motion).norm() <= accuracy * motion.desired.norm());
  };
  const std::vector<Motion> sample = sample_of(motions);
  const auto wrong = static_cast<std::size_t>(std::ranges::count_if(sample, differ));
  if (wrong == 0) return {};
  return "not timed: " + grouped(wrong) + " of " + counted(sample.size(), "step") +
         " are not the same";
}

std::vector<Motion> pressed_motions(const IndexedMesh& on, std::size_t count,
                                    const MotionKind& kind, Random random) {
  constexpr std::size_t cycles_of_a_stroke = 50;
  MotionConstraint guard = certified(on, kind.clearance);
  NearestTriangle nearest(*on.mesh, *on.index);
  std::vector<Motion> motions;
  motions.reserve(count);
  const std::size_t strokes = count / cycles_of_a_stroke + 1;
  for (int round = 0; round < most_rounds && motions.size() < count; ++round) {
    for (Vec3 tip : surface_points(*on.mesh, strokes, 1.5 * kind.clearance, random)) {
      const ClosestPoint closest = nearest(tip, 2.0 * kind.clearance).closest;
      if (closest.distance < kind.clearance) continue;
      constexpr double not_quite = 0.999;  // rounding must not make it too close
      tip += not_quite * (1.0 - kind.clearance / closest.distance) * closest.offset;
      const Vec3 heading = random.direction();
      for (std::size_t cycle = 0; cycle < cycles_of_a_stroke && motions.size() < count; ++cycle) {
        const ClosestPoint below = nearest(tip, 1.01 * kind.clearance).closest;
        const Vec3 down = below.offset / below.distance;
        Vec3 along = heading - heading.dot(down) * down;
        if (along.norm() > 0.0) along.normalize();
        const Motion motion{.tip = tip, .desired = pressing_increment(down, along, kind, random)};
        const Step step = guard.step(motion);
        if (!step.ok()) break;
        if (step.status == Status::limited) motions.push_back(motion);
        tip += step.motion;
      }
    }
  }
  if (motions.size() < count) {
    throw Error("the mesh has hardly any place for a tip that is " + length_text(kind.clearance) +
                " away from it");
  }
  return motions;
}

std::vector<Motion> free_motions(const IndexedMesh& on, std::size_t count, const FreeSpace& space,
                                 const MotionKind& kind, Random random) {
  NearestTriangle nearest(*on.mesh, *on.index);
  std::vector<Motion> motions;
  Vec3 tip = somewhere_free(*on.mesh, nearest, space, random);
  Vec3 heading = random.direction();
  double distance = nearest(tip, space.farthest).closest.distance;
  while (motions.size() < count) {
    heading = (heading + 0.1 * random.direction()).normalized();
    const double length = random.uniform(kind.shortest, kind.longest);
    const Hit hit = nearest(tip, distance + kind.longest);
    distance = hit.closest.distance;
    // Turns gently at the bounds of the space.
    const Vec3 away = -hit.closest.offset / distance;
    constexpr double gentle = 0.3;
    if (distance < space.nearest + 5.0 * kind.longest) heading += gentle * away;
    if (distance > space.farthest - 5.0 * kind.longest) heading -= gentle * away;
    heading.normalize();
    // Turns on the spot if that is not enough.
    if (distance < space.nearest + kind.longest) heading = away;
    if (distance > space.farthest - kind.longest) heading = -away;
    motions.push_back({.tip = tip, .desired = length * heading});
    tip += motions.back().desired;
  }
  return motions;
}

std::vector<Motion> held_back_motions(const IndexedMesh& on, std::size_t count,
                                      const MotionKind& kind, Random random) {
  MotionConstraint guard = certified(on, kind.clearance);
  std::vector<Motion> motions;
  for (int round = 0; round < most_rounds && motions.size() < count; ++round) {
    for (const Motion& motion : unrelated_motions(*on.mesh, count, kind, random)) {
      if (motions.size() == count) break;
      if (guard.step(motion).status == Status::limited) motions.push_back(motion);
    }
  }
  if (motions.empty()) throw Error("the mesh limits hardly any of the motions");
  return motions;
}

std::vector<Motion> central_motions(std::size_t count, const MotionKind& kind, Random random) {
  std::vector<Motion> motions;
  constexpr double nearness = 1.0;  // [mm]
  Vec3 tip = Vec3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 step = random.uniform(kind.shortest, kind.longest) * random.direction();
    const Vec3 desired = (tip + step).norm() < nearness ? step : Vec3(-step);
    motions.push_back({.tip = tip, .desired = desired});
    tip += desired;
    if (tip.norm() > nearness) tip = Vec3::Zero();
  }
  return motions;
}

}  // namespace keepout::app
