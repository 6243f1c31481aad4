// SPDX-License-Identifier: BSD-3-Clause
// Motions that would end too close by a small fraction of their length, 1e-9 to 1e-3. An early
// acceptance or a search region that is slightly wrong lets such motions pass.

#include "accuracy/certified_loop.h"

namespace keepout::test::shallow_breach {
namespace {

Vec3 across(const Vec3& in, Random& random) {
  const Vec3 direction = random.direction();
  return direction - direction.dot(in) * in;
}

double log_uniform(Random& random, double low, double high) {
  return std::pow(10.0, random.uniform(std::log10(low), std::log10(high)));
}

/// Commands motions from beyond the margin that would end too close by 1e-9 to 1e-4 of the radius.
/// Fails if a step makes one of them.
void glance(Loop& loop, double radius, std::size_t tips, Random& random, int& moved) {
  const double beyond = 0.3 * radius * random.uniform();
  for (const Vec3& tip : places(loop, tips, loop.margin() + beyond, random)) {
    const Vec3 in = loop.towards_surface(tip);
    for (int i = 0; i < 6; ++i) {
      const double missing = radius * log_uniform(random, 1e-9, 1e-4);
      const Vec3 desired =
          (beyond + missing) * in + 0.5 * radius * random.uniform() * across(in, random);
      ASSERT_NO_FATAL_FAILURE(expect_safe(loop, tip, loop.step(tip, desired), moved));
    }
  }
}

TEST(ShallowBreach, OfAMotionThatGlancesIsSeen) {
  Random random(6);
  int moved = 0;
  constexpr const char* names[] = {"gear", "cortex", "sphere", "cube", "needles", "fan"};
  for (int trial = 0; trial < trials(12); ++trial) {
    SCOPED_TRACE(names[trial % 6]);
    Loop loop(make_shape(names[trial % 6]),
              {.options = {.radius = 1.0, .margin = trial % 2 == 0 ? 0.2 : 1.0}});
    ASSERT_NO_FATAL_FAILURE(glance(loop, 1.0, 12, random, moved));
  }
  EXPECT_GT(moved, trials(400));
}

// The index rounds these coordinates to single precision, by up to 2^-24 of the size of the mesh.
// Triangles, margin and motions are a hundred thousand times smaller than the mesh.
TEST(ShallowBreach, BesideSmallTrianglesOfALargeMeshIsSeen) {
  Random random(9);
  int moved = 0;
  constexpr double size = 1e-3;
  for (int trial = 0; trial < 10; ++trial) {
    Surface surface;
    for (const double side : {-100.0, 100.0}) {
      const Vec3 middle = side * random.direction();
      for (int t = 0; t < 20; ++t) {
        for (int corner = 0; corner < 3; ++corner) {
          surface.vertices.push_back(middle + size * random.direction());
        }
        const auto last = static_cast<VertexId>(surface.vertices.size() - 1);
        surface.triangles.push_back({last - 2, last - 1, last});
      }
    }
    Loop loop(std::move(surface), {.options = {.radius = size, .margin = size}});
    ASSERT_NO_FATAL_FAILURE(glance(loop, size, 10, random, moved));
  }
  EXPECT_GT(moved, 300);
}

// The search region of a motion reaches farthest straight ahead. The bounding box of a face that is
// perpendicular to an axis is no larger than the face. So the face touches only the rim of the
// region.
TEST(ShallowBreach, OfAMotionStraightAtAFaceIsSeen) {
  Random random(7);
  int moved = 0;
  for (const double margin : {0.005, 0.2, 1.0, 4.0}) {
    Loop loop(make_cube(5.0), {.options = {.radius = 10.0, .margin = margin}});
    const double face = loop.mesh().bounds().high.x();
    for (int i = 0; i < trials(2000); ++i) {
      const auto axis = static_cast<Eigen::Index>(random.below(3));
      const double length = random.uniform(0.1, 9.0);
      const double missing = log_uniform(random, 1e-9, 1e-3) * (margin + length);
      Vec3 tip(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5));
      tip *= face;
      tip[axis] = face + margin + length - missing;
      // The first of these tips is far from the last step, so that the traversal cache is rebuilt.
      for (int repeat = 0; repeat < 3; ++repeat) {
        const Vec3 desired = -length * Vec3::Unit(axis);
        ASSERT_NO_FATAL_FAILURE(expect_safe(loop, tip, loop.step(tip, desired), moved));
        for (int a = 0; a < 3; ++a) tip[a] += a == axis ? 0.0 : random.uniform(-0.1, 0.1);
      }
    }
  }
  EXPECT_GT(moved, trials(400));
}

// A motion along a plane may lose a second tolerance to the rounding of the solver.
TEST(ShallowBreach, OfAMotionWithoutPlanesIsOneToleranceAtTheMost) {
  Random random(10);
  int free = 0;
  Loop loop(make_shape("cube"), {.options = {.radius = 1.0, .margin = 0.2}});
  for (const Vec3& tip : places(loop, trials(300), 0.5, random)) {
    const double missing = random.uniform(0.5, 2.0) * loop.tolerance(tip);
    const Vec3 desired = (0.3 + missing) * loop.towards_surface(tip);
    const Step step = loop.step(tip, desired);
    if (step.status != Status::free || !step.planes.empty()) continue;
    ASSERT_LE(loop.loss(tip, tip + step.motion), 1.1) << tip.transpose();
    ++free;
  }
  EXPECT_GT(free, trials(50));
}

// With damping, the solver returns a motion beside the desired one. The desired motion is clear,
// but this does not prove that the returned motion is.
TEST(ShallowBreach, BesideADesiredMotionThatIsFreeIsSeen) {
  Random random(5);
  int moved = 0;
  MotionConstraintSettings settings{.options = {.radius = 1.0, .margin = 0.2}};
  for (const double damping : {1e-5, 1e-4, 5e-4}) {
    settings.options.damping = damping;
    Loop loop(make_shape("cube"), settings);
    for (const Vec3& tip : places(loop, 30, 0.2001, random)) {
      const Vec3 in = loop.towards_surface(tip);
      for (int i = 0; i < trials(40); ++i) {
        TipJacobian::Matrix columns(3, 3);
        for (int c = 0; c < 3; ++c) columns.col(c) = random.uniform(0.1, 1.5) * random.direction();
        const Vec3 desired =
            random.uniform(0.05, 1.0) * across(in, random) + random.uniform(-3e-4, 1e-4) * in;
        const Step step =
            loop.guard().step({.tip = tip, .desired = desired, .jacobian = TipJacobian(columns)});
        ASSERT_NO_FATAL_FAILURE(expect_safe(loop, tip, step, moved));
      }
    }
  }
  EXPECT_GT(moved, trials(1000));
}

}  // namespace
}  // namespace keepout::test::shallow_breach
