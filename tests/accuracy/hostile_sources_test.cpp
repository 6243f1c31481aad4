// SPDX-License-Identifier: BSD-3-Clause
// Makes ten million hostile steps of the certified rule, each with the traversal of a tree and with
// all hits around. Status, motion, increment, planes and distance are bitwise identical on every
// SIMD target.

#include <cstdio>
#include <functional>

#include "engine/activation/sources.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/query.h"
#include "trials.h"

namespace keepout {
namespace {

constexpr std::size_t steps_in_all = 10'000'000;
constexpr std::size_t strokes_on_one_setting = 100;
constexpr std::size_t cycles_in_a_stroke = 8;

const TipJacobian::Matrix& five_joints() {
  static const TipJacobian::Matrix jacobian = [] {
    TipJacobian::Matrix j(3, 5);
    j << 1, 0, 0, 0.5, -0.3, 0, 1, 0, 0.2, 0.7, 0, 0, 1, -0.4, 0.1;
    return j;
  }();
  return jacobian;
}

/// Random lengths and options. Margins range from just above the least allowed, eight tolerances,
/// to a tenth of the mesh. Motions range from a hundredth of the margin to far beyond it.
struct Setting {
  StepOptions options;
  double tolerance;  // of the certified rule, near the origin [length]
  bool has_joints;

  Setting(const Mesh& mesh, Random& random) {
    const double size = mesh.bounds().size().norm();
    const double coarsest = 2e-10 * (mesh.longest_edge() + 0.2 * size);
    const double least = 8.2 * coarsest;
    const bool is_least = random.below(3) == 0;
    const double margin = is_least ? least * random.uniform(1.0, 2.0)
                                   : least * std::pow(0.1 * size / least, random.uniform());
    const double longest = margin * std::pow(10.0, random.uniform(-2.0, 6.0));
    options.radius = std::min(longest, 0.2 * size);
    options.margin = margin;
    options.recovery = margin * std::pow(10.0, random.uniform(-3.0, 1.0));
    options.refinements = static_cast<int>(random.below(5));
    options.nodes = random.below(8) == 0 ? 8 : 0;
    options.query = random.below(6) == 0 ? Query::sphere : Query::motion;
    tolerance = 2e-10 * (mesh.longest_edge() + options.radius + margin);
    has_joints = random.below(8) == 0;
    options.damping = has_joints ? 1e-3 : 0.0;
  }
};

/// Returns corners of a mesh, points on its edges, and twice as many points on its faces.
std::vector<Vec3> points_on(const Mesh& mesh, Random& random) {
  constexpr std::size_t of_a_kind = 5000;
  std::vector<Vec3> points = surface_points(mesh, 2 * of_a_kind, 0.0, random);
  const std::vector<Vec3> corners = vertex_points(mesh, of_a_kind, random);
  const std::vector<Vec3> of_edges = edge_points(mesh, of_a_kind, random);
  points.insert(points.end(), corners.begin(), corners.end());
  points.insert(points.end(), of_edges.begin(), of_edges.end());
  return points;
}

/// Returns a tip near a point of the mesh. Its distance covers each multiple of the tolerance at
/// which the rule changes its behavior.
Vec3 hostile_tip(const Mesh& mesh, const SpatialIndex& index, const Vec3& on,
                 const Setting& setting, Random& random) {
  const double margin = setting.options.margin;
  const double steps = 0.25 * std::floor(random.uniform(-2.0, 24.0));  // [tolerances]
  const double far[] = {margin - steps * setting.tolerance, margin * random.uniform(0.0, 1.5),
                        random.uniform(0.0, 12.0) * setting.tolerance, 0.0};
  const double clearance = far[random.below(4)];
  const Vec3 off = on + (clearance + 1e-3 * margin) * random.direction();
  NearestTriangle nearest(mesh, index);
  const ClosestPoint closest = nearest(off).closest;
  if (!(closest.distance > 0.0)) return off;
  return off + closest.offset * (1.0 - clearance / closest.distance);
}

/// Returns a unit vector: into the surface, along it, at an angle into it, along an axis, or any.
Vec3 hostile_way(const Mesh& mesh, const Vec3& tip, const SpatialIndex& index, Random& random) {
  NearestTriangle nearest(mesh, index);
  const Vec3 down = nearest(tip).closest.offset;
  const double depth = down.norm();
  const Vec3 towards = depth > 0.0 ? Vec3(down / depth) : random.direction();
  const Vec3 any = random.direction();
  switch (random.below(5)) {
    case 0:
      return towards;
    case 1:
      return (any - any.dot(towards) * towards).normalized();
    case 2:
      return (towards + any).normalized();
    case 3:
      return Vec3::Unit(static_cast<Eigen::Index>(random.below(3)));
    default:
      return any;
  }
}

/// Counts the steps, and those that are limited or recovering.
struct Tally {
  std::size_t steps = 0;
  std::size_t held = 0;
};

/// Runs strokes on one mesh. The tip makes the returned motions.
void attack(Sources& sources, std::size_t steps, Random& random, Tally& tally) {
  const std::size_t end = tally.steps + steps;
  const std::vector<Vec3> points = points_on(*sources.mesh, random);
  while (tally.steps < end) {
    const Setting setting(*sources.mesh, random);
    sources.set_options(setting.options);
    for (std::size_t stroke = 0; stroke < strokes_on_one_setting; ++stroke) {
      const Vec3& on = points[random.below(points.size())];
      Vec3 tip = hostile_tip(*sources.mesh, *sources.tree, on, setting, random);
      for (std::size_t cycle = 0; cycle < cycles_in_a_stroke; ++cycle) {
        const double length = setting.options.radius * (1.0 - std::pow(random.uniform(), 3));
        const Vec3 way = hostile_way(*sources.mesh, tip, *sources.tree, random);
        Motion motion{.tip = tip, .desired = length * way};
        if (setting.has_joints) motion.jacobian.emplace(five_joints());
        const Outcome asking = sources.asking(motion);
        const Outcome traversing = sources.traversing(motion);
        ASSERT_EQ(traversing, asking)
            << "tip " << tip.transpose() << ", desired " << motion.desired.transpose()
            << ", margin " << setting.options.margin << ", radius " << setting.options.radius;
        ++tally.steps;
        tally.held += asking.status == Status::limited || asking.status == Status::recovering;
        if (!is_ok(asking.status)) break;
        tip += asking.motion;
      }
    }
  }
}

class HostileSources : public testing::TestWithParam<std::string_view> {
 protected:
  ~HostileSources() override { use_simd_target(simd_targets().front()); }
};

// Each target makes a part of the ten million steps.
TEST_P(HostileSources, AgreeBitForBitOverTenMillionStepsOnAllTargets) {
  use_simd_target(GetParam());
  const std::vector<std::string> shapes = names_of_shapes();
  const std::size_t steps = steps_in_all / simd_targets().size() / shapes.size() + 1;
  Random random(101 + std::hash<std::string_view>()(GetParam()));
  Tally tally;
  for (const std::string& shape : shapes) {
    SCOPED_TRACE(shape);
    Sources sources(make_shape(shape));
    attack(sources, steps, random, tally);
    if (HasFatalFailure()) return;
  }
  EXPECT_GE(tally.steps, steps_in_all / simd_targets().size());
  EXPECT_GT(tally.held, tally.steps / 4);
  std::printf("%zu steps, %zu of them limited or recovering\n", tally.steps, tally.held);
}

INSTANTIATE_TEST_SUITE_P(EachTarget, HostileSources, testing::ValuesIn(simd_targets()), by_name);

}  // namespace
}  // namespace keepout
