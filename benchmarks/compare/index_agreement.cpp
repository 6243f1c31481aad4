// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "compare/compare.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/motions.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree.h"
#include "keepout/oracle/distance.h"
#include "keepout/registry.h"

namespace keepout::app {
namespace {

/// The result of an index at one pose.
struct Finding {
  std::vector<Hit> hits;  // after the exact kernel, sorted
  std::vector<HalfSpace> planes;
  Status status = Status::invalid_input;
  Vec3 motion = Vec3::Zero();
  bool repeats = false;  // a candidate came twice
};

/// The results of one index under one rule.
struct Findings {
  IndexAgreement row;
  std::vector<Finding> at = {};  // each pose; kept for brute force only
};

std::vector<Motion> motions_of(const IndexComparison& comparison) {
  const Mesh& mesh = *comparison.mesh;
  const PdTree tree(comparison.mesh);
  Random random(comparison.seed);
  const MotionKind kind;
  const std::size_t others = comparison.poses / 6;
  std::vector<Motion> motions = unrelated_motions(mesh, others, kind, random);
  for (const auto& points :
       {vertex_points(mesh, others, random), edge_points(mesh, others, random)}) {
    for (const Vec3& point : points) {
      motions.push_back({.tip = point, .desired = kind.longest * random.direction()});
    }
  }
  for (const Motion& motion :
       contact_motions(mesh, tree, comparison.poses - motions.size(), kind, random)) {
    motions.push_back(motion);
  }
  return motions;
}

/// Returns the number of triangles of one set that are missing in the other.
std::size_t missing(const std::vector<Hit>& of, const std::vector<Hit>& in) {
  return static_cast<std::size_t>(std::ranges::count_if(of, [&](const Hit& hit) {
    return !std::ranges::binary_search(in, hit.triangle, {}, &Hit::triangle);
  }));
}

/// Returns the largest angle between planes with the same position [rad]; half a turn if their
/// numbers differ.
double plane_angle(const std::vector<HalfSpace>& one, const std::vector<HalfSpace>& other) {
  if (one.size() != other.size()) return std::numbers::pi;
  double worst = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const Vec3& a = one[i].normal;
    const Vec3& b = other[i].normal;
    worst = std::max(worst, std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  return worst;
}

/// Returns the largest error of distances and closest points, by exact arithmetic.
double closest_point_error(const Mesh& mesh, const Vec3& center, const std::vector<Hit>& hits) {
  double worst = 0.0;
  for (const Hit& hit : hits) {
    const Triangle triangle = mesh.triangle(hit.triangle);
    const Vec3 point = center + hit.closest.offset;
    const double distance = oracle::exact_distance({center, center}, triangle, 0.0).distance;
    const double off = oracle::exact_distance({point, point}, triangle, 0.0).distance;
    worst = std::max({worst, std::abs(hit.closest.distance - distance), off});
  }
  return worst;
}

/// Compares normals, offsets and source triangles bitwise.
bool are_same(const HalfSpace& a, const HalfSpace& b) {
  return a.normal == b.normal && a.offset == b.offset && a.source == b.source;
}

/// Returns true if `some` are a subsequence of `all`.
bool are_among(const std::vector<HalfSpace>& some, const std::vector<HalfSpace>& all) {
  auto next = all.begin();
  for (const HalfSpace& plane : some) {
    next = std::find_if(next, all.end(), [&](const HalfSpace& o) { return are_same(plane, o); });
    if (next++ == all.end()) return false;
  }
  return true;
}

void compare(const Finding& got, const Finding& expected, IndexAgreement& agreement) {
  ++agreement.poses;
  agreement.missed += missing(expected.hits, got.hits);
  agreement.invented += missing(got.hits, expected.hits) + (got.repeats ? 1 : 0);
  agreement.step_difference =
      std::max(agreement.step_difference, (got.motion - expected.motion).norm());
  // A rule that searches may leave out planes that no possible motion reaches.
  const bool same_planes = are_among(got.planes, expected.planes) &&
                           (agreement.searched || got.planes.size() == expected.planes.size());
  if (!same_planes) {
    agreement.plane_angle =
        std::max(agreement.plane_angle, plane_angle(got.planes, expected.planes));
  }
  if (!(got.status == expected.status && got.motion == expected.motion && same_planes)) {
    ++agreement.steps_that_differ;
  }
}

}  // namespace

bool is_same(const Hit& one, const Hit& other) {
  return one.triangle == other.triangle && one.closest.offset == other.closest.offset &&
         one.closest.distance == other.closest.distance &&
         one.closest.feature == other.closest.feature;
}

std::vector<IndexAgreement> compare_indices(const IndexComparison& comparison,
                                            const Stopped& stopped) {
  const std::shared_ptr<const Mesh>& mesh = comparison.mesh;
  const std::vector<Motion> motions = motions_of(comparison);
  Progress progress("compare indices", motions.size() * comparison.activations.size() *
                                           (comparison.indices.size() + 1));
  // Asks one pose after the other, as a program would, and compares with the truth if it is given.
  // Returns empty after a stop.
  const auto ask = [&](const std::string& name, const std::shared_ptr<const SpatialIndex>& index,
                       const std::string& rule,
                       const Findings* truth = nullptr) -> std::optional<Findings> {
    constexpr double radius = 1.0;  // of the motion sphere [mm]
    MotionConstraint guard =
        make_motion_constraint(mesh, index, {.activation = rule, .options = {.radius = radius}});
    const double reach = guard.options().radius + guard.options().margin;
    Budget budget;
    Neighborhood around(mesh, index, mesh->triangle_count(), budget);
    Findings findings{.row = {.mesh = comparison.mesh_name,
                              .index = name,
                              .activation = rule,
                              .searched = !guard.makes_queries()}};
    const auto find = [&](std::size_t i) -> Finding {
      const Motion& motion = motions[i];
      const bool fits = around.gather({motion.tip, reach});  // unless an index returns some twice
      const Step step = guard.step(motion);
      TriangleBuffer& candidates = around.candidates();
      std::ranges::sort(candidates);
      return {.hits = {around.hits().begin(), around.hits().end()},
              .planes = {step.planes.begin(), step.planes.end()},
              .status = step.status,
              .motion = step.motion,
              .repeats = !fits || std::ranges::adjacent_find(candidates) != candidates.end()};
    };
    double& worst = findings.row.closest_point_error;
    if (truth != nullptr) worst = truth->row.closest_point_error;
    const auto judge = [&](std::size_t i, Finding found) {
      // Exact arithmetic is slow: use it once for identical hits.
      if (truth == nullptr || !std::ranges::equal(found.hits, truth->at[i].hits, is_same)) {
        worst = std::max(worst, closest_point_error(*mesh, motions[i].tip, found.hits));
      }
      if (truth != nullptr) {
        compare(found, truth->at[i], findings.row);
      } else {
        findings.at.push_back(std::move(found));
      }
    };
    if (!ask_all(motions.size(), progress, stopped, find, judge)) return std::nullopt;
    return findings;
  };

  std::map<std::string, Findings> expected;  // of brute force, by rule
  const auto brute_force = std::make_shared<const BruteForce>(mesh);
  std::vector<IndexAgreement> agreements;
  for (const std::string& rule : comparison.activations) {
    std::optional<Findings> truth = ask("brute_force", brute_force, rule);
    if (!truth) return agreements;
    expected.emplace(rule, *std::move(truth));
  }
  for (const std::string& name : comparison.indices) {
    // One index at a time: for a large mesh, all may not fit in memory.
    const std::shared_ptr<const SpatialIndex> index = index_backends().named(name).make(mesh);
    for (const std::string& rule : comparison.activations) {
      std::optional<Findings> got = ask(name, index, rule, &expected.at(rule));
      if (!got) return agreements;
      agreements.push_back(std::move(got->row));
    }
  }
  return agreements;
}

}  // namespace keepout::app
