// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "compare/index_agreement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/parts.h"
#include "bench/pipeline.h"
#include "keepout/activation/registry.h"
#include "keepout/fixtures/motions.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree.h"
#include "keepout/oracle/exact_distance.h"
#include "keepout/registry.h"
#include "keepout/solvers/active_set.h"

namespace keepout::app {
namespace {

/// What an index came to at one pose.
struct Finding {
  Vec3 center;            // of the ball
  std::vector<Hit> hits;  // after the exact kernel, sorted
  std::vector<HalfSpace> planes;
  Answer answer;
  bool repeats = false;  // a candidate came twice
};

/// A rule, and what brute force came to under it at each pose.
struct Rule {
  RuleSetting setting;
  std::unique_ptr<Activation> activation;
  std::vector<Finding> expected;
};

std::vector<Motion> motions_of(const IndexComparison& comparison) {
  const Mesh& mesh = *comparison.mesh;
  const PdTree tree(comparison.mesh);
  Random random(comparison.seed);
  const MotionKind kind{.clearance = comparison.margin};
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

Finding find(const Pipeline& pipeline, const Motion& motion) {
  const Ball ball = ball_of(pipeline.setting, pipeline.rule, motion);
  Workspace& work = pipeline.work;
  work.candidates.clear();
  work.hits.clear();
  pipeline.index.collect(ball, work.candidates);
  refine(pipeline.mesh, ball, work.candidates.view(), work.hits);
  Finding finding{.center = ball.center,
                  .hits = {work.hits.begin(), work.hits.end()},
                  .planes = {},
                  .answer = {}};
  std::sort(work.candidates.begin(), work.candidates.end());
  finding.repeats =
      std::adjacent_find(work.candidates.begin(), work.candidates.end()) != work.candidates.end();
  finding.answer = pipeline.ask(motion);
  finding.planes.assign(work.planes.begin(), work.planes.end());
  return finding;
}

/// The part of the one set of triangles that is missing in the other.
std::size_t missing(const std::vector<Hit>& of, const std::vector<Hit>& in) {
  return static_cast<std::size_t>(std::ranges::count_if(of, [&](const Hit& hit) {
    return !std::ranges::binary_search(in, hit.triangle, {}, &Hit::triangle);
  }));
}

/// The largest angle between planes of the same number. [rad] Half a turn if the numbers differ.
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

/// How far distances and closest points are off, by exact arithmetic.
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

/// To the last bit: of normals, offsets and the triangles that called for them.
bool are_same(const std::vector<HalfSpace>& one, const std::vector<HalfSpace>& other) {
  return std::ranges::equal(one, other, [](const HalfSpace& a, const HalfSpace& b) {
    return a.normal == b.normal && a.offset == b.offset && a.source == b.source;
  });
}

void compare(const Mesh& mesh, const Finding& got, const Finding& expected,
             IndexAgreement& agreement) {
  ++agreement.poses;
  agreement.missed += missing(expected.hits, got.hits);
  agreement.invented += missing(got.hits, expected.hits) + (got.repeats ? 1 : 0);
  agreement.plane_angle = std::max(agreement.plane_angle, plane_angle(got.planes, expected.planes));
  agreement.step_difference =
      std::max(agreement.step_difference, (got.answer.motion - expected.answer.motion).norm());
  if (!(got.answer == expected.answer && are_same(got.planes, expected.planes))) {
    ++agreement.steps_that_differ;
  }
  agreement.closest_point_error =
      std::max(agreement.closest_point_error, closest_point_error(mesh, got.center, got.hits));
}

}  // namespace

std::vector<IndexAgreement> compare_indices(const IndexComparison& comparison,
                                            const std::function<void()>& done) {
  const Mesh& mesh = *comparison.mesh;
  Workspace work({.triangles = std::max<std::size_t>(mesh.triangle_count(), 1), .variables = 3});
  ActiveSet solver;
  solver.reserve(3, static_cast<int>(work.planes.capacity()));
  const std::vector<Motion> motions = motions_of(comparison);
  std::vector<Rule> rules;
  for (const std::string& activation : comparison.activations) {
    rules.push_back({{activation, comparison.radius, comparison.margin},
                     make_activation(activation, comparison.mesh),
                     {}});
    rules.back().activation->reserve(work.candidates.capacity());
  }
  const auto find_with = [&](const SpatialIndex& index, const Rule& rule, const Motion& motion) {
    done();
    return find({mesh, index, *rule.activation, solver, work, rule.setting}, motion);
  };

  const BruteForce brute_force(comparison.mesh);
  for (Rule& rule : rules) {
    for (const Motion& motion : motions) {
      rule.expected.push_back(find_with(brute_force, rule, motion));
    }
  }
  std::vector<IndexAgreement> agreements;
  for (const std::string& name : comparison.indices) {
    // One at a time: of a large mesh they need not fit all at once.
    const auto index =
        entry_named(name, indices(), "index", absent_indices()).make(comparison.mesh);
    for (const Rule& rule : rules) {
      IndexAgreement& agreement = agreements.emplace_back(IndexAgreement{
          .mesh = comparison.mesh_name, .index = name, .activation = rule.setting.activation});
      for (std::size_t i = 0; i < motions.size(); ++i) {
        compare(mesh, find_with(*index, rule, motions[i]), rule.expected[i], agreement);
      }
    }
  }
  return agreements;
}

}  // namespace keepout::app
