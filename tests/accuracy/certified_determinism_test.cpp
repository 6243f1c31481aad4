// SPDX-License-Identifier: BSD-3-Clause
// Motions are bitwise identical with any index, SIMD target, numbering and winding of the
// triangles.

#include "accuracy/certified_loop.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/index/query.h"

namespace keepout::test::certified_determinism {
namespace {

constexpr double margin = 0.3;
constexpr double radius = 1.0;

MotionConstraintSettings settings() {
  return {.options = {.radius = radius, .margin = margin}, .capacity = {.planes = 200}};
}

struct Start {
  Vec3 tip;
  Vec3 press;  // unit vector, towards the surface
};

using GuidesOf = std::vector<Guide> (*)(const Start&);

std::vector<Guide> no_guides(const Start&) { return {}; }

/// Returns a corridor, and a ball that begins beyond the tip.
std::vector<Guide> corridor_and_ball(const Start& start) {
  return {Guide::point("corridor", Region::slab(start.tip, Vec3(0.6, 0.8, 0.0), 0.3)),
          Guide::point("ball", Region::ball(start.tip - start.press, 0.9))};
}

/// Runs a closed loop from each start, which presses into the surface half of the time.
std::vector<Cycle> loops(MotionConstraint& guard, const std::vector<Start>& starts, int count,
                         GuidesOf guides_of = no_guides) {
  std::vector<Cycle> out;
  Random random(5);
  for (const Start& start : starts) {
    guard.set_guides(guides_of(start));
    Vec3 tip = start.tip;
    Vec3 drift = Vec3::Zero();
    for (int i = 0; i < count; ++i) {
      if (i % 10 == 0) drift = i % 20 == 0 ? start.press : random.direction();
      const Vec3 desired = 0.5 * (drift + 0.7 * random.direction());
      const Step step = guard.step({.tip = tip, .desired = desired});
      out.push_back({step.status, step.motion});
      tip += step.motion;
    }
  }
  return out;
}

/// Runs the loops with a new guard for the surface.
std::vector<Cycle> loops(const Surface& surface, MotionConstraintSettings with,
                         const std::vector<Start>& starts, int count,
                         GuidesOf guides_of = no_guides) {
  auto guard = make_motion_constraint(mesh_of(surface), with);
  return loops(guard, starts, count, guides_of);
}

std::vector<Start> starts_on(const Surface& surface, std::size_t count) {
  Random random(3);
  const auto mesh = mesh_of(surface);
  const PdTree tree(mesh);
  NearestTriangle nearest(*mesh, tree);
  std::vector<Start> out;
  for (const double offset : {1.2 * margin, 0.4 * margin}) {  // free, and too close
    for (const Vec3& tip : surface_points(*mesh, count, offset, random)) {
      out.push_back({tip, nearest(tip).closest.offset.normalized()});
    }
  }
  return out;
}

std::size_t limited(const std::vector<Cycle>& cycles) {
  return static_cast<std::size_t>(
      std::count_if(cycles.begin(), cycles.end(),
                    [](const Cycle& cycle) { return cycle.status == Status::limited; }));
}

class CertifiedDeterminism : public testing::TestWithParam<Shape> {};

TEST_P(CertifiedDeterminism, TheIndexDoesNotMatter) {
  const Surface surface = GetParam().make();
  const std::vector<Start> starts = starts_on(surface, 2);
  const std::vector<Cycle> expected = loops(surface, settings(), starts, 40);
  EXPECT_GT(limited(expected), 5u);
  for (const IndexBackend& backend : index_backends()) {
    MotionConstraintSettings other = settings();
    other.index = backend.name;
    ASSERT_EQ(loops(surface, other, starts, 40), expected) << backend.name;
  }
}

/// Builds the index, classifies the tips and computes the motions on each SIMD target alone.
TEST_P(CertifiedDeterminism, TheProcessorDoesNotMatter) {
  const Surface surface = GetParam().make();
  const std::vector<Start> starts = starts_on(surface, 4);
  MotionConstraintSettings branching = settings();
  branching.options.nodes = 8;
  MotionConstraintSettings paper = settings();
  paper.activation = "paper";
  for (const MotionConstraintSettings& with : {settings(), branching, paper}) {
    std::vector<Cycle> expected;
    on_each_simd_target([&] {
      const std::vector<Cycle> got = loops(surface, with, starts, 40);
      if (expected.empty()) expected = got;
      EXPECT_GT(limited(got), 5u);
      EXPECT_TRUE(got == expected);
    });
  }
}

TEST_P(CertifiedDeterminism, TheNumberingDoesNotMatter) {
  const Surface surface = GetParam().make();
  const std::vector<Start> starts = starts_on(surface, 10);
  const std::vector<Cycle> expected = loops(surface, settings(), starts, 100);
  Random random(1);
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(loops(renumbered(surface, random), settings(), starts, 100), expected);
  }
}

// Without the classification of tips, which depends on the winding.
TEST_P(CertifiedDeterminism, TheWindingDoesNotMatter) {
  const Surface surface = GetParam().make();
  const std::vector<Start> starts = starts_on(surface, 10);
  MotionConstraintSettings with = settings();
  with.inside = Inside::taken_as_is;
  const std::vector<Cycle> expected = loops(surface, with, starts, 100);
  Random random(2);
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(loops(rewound(renumbered(surface, random), random), with, starts, 100), expected);
  }
}

TEST_P(CertifiedDeterminism, HoldsWithGuides) {
  const Surface surface = GetParam().make();
  const std::vector<Start> starts = starts_on(surface, 2);
  MotionConstraintSettings with = settings();
  with.inside = Inside::taken_as_is;
  const std::vector<Cycle> expected = loops(surface, with, starts, 40, corridor_and_ball);
  EXPECT_NE(expected, loops(surface, with, starts, 40)) << "the guides limit motions";
  for (const IndexBackend& backend : index_backends()) {
    MotionConstraintSettings other = with;
    other.index = backend.name;
    ASSERT_EQ(loops(surface, other, starts, 40, corridor_and_ball), expected) << backend.name;
  }
  on_each_simd_target(
      [&] { EXPECT_TRUE(loops(surface, with, starts, 40, corridor_and_ball) == expected); });
  Random random(7);
  const Surface other = rewound(renumbered(surface, random), random);
  EXPECT_EQ(loops(other, with, starts, 40, corridor_and_ball), expected);
}

TEST_P(CertifiedDeterminism, OneCycleDoesNotDependOnThoseBefore) {
  const Surface surface = GetParam().make();
  const std::vector<Start> starts = starts_on(surface, 10);
  auto guard = make_motion_constraint(mesh_of(surface), settings());
  const std::vector<Cycle> expected = loops(guard, starts, 100);
  ASSERT_EQ(loops(guard, starts, 100), expected);
}

/// Counts cycles in which the statuses of two guards differ. Fails if their motions differ by more
/// than `most`.
struct Differences {
  void add(const Step& one, const Step& two, double most) {
    ++cycles;
    if (one.status != two.status) ++other_status;
    EXPECT_LE((one.motion - two.motion).norm(), most) << name(one.status) << name(two.status);
  }

  std::size_t cycles = 0;
  std::size_t other_status = 0;
};

TEST_P(CertifiedDeterminism, HowFarIsLookedHardlyMatters) {
  const Surface surface = GetParam().make();
  const auto mesh = mesh_of(surface);
  MotionConstraintSettings wide = settings();
  wide.options.query = Query::sphere;
  auto guard = make_motion_constraint(mesh, settings());
  auto wide_guard = make_motion_constraint(mesh, wide);
  Random random(4);
  Differences differences;
  for (const Start& start : starts_on(surface, 10)) {
    Vec3 tip = start.tip;
    for (int i = 0; i < 60; ++i) {
      const Vec3 desired = random.uniform(0.1, 0.5) * (start.press + random.direction());
      const Step one = guard.step({.tip = tip, .desired = desired});
      differences.add(one, wide_guard.step({.tip = tip, .desired = desired}), 1e-9 * radius);
      tip += one.motion;
    }
  }
  EXPECT_EQ(differences.other_status, 0u);
}

double on_grid(double x) { return std::ldexp(std::round(std::ldexp(x, 20)), -20); }

Vec3 on_grid(const Vec3& p) { return {on_grid(p.x()), on_grid(p.y()), on_grid(p.z())}; }

TEST_P(CertifiedDeterminism, TheOriginHardlyMatters) {
  // On a grid of 2^-20, a translation of the mesh changes no difference of coordinates.
  Surface surface = GetParam().make();
  const bool is_far = GetParam().name == "far_cube";
  for (Vec3& v : surface.vertices) v = on_grid(v);
  const Vec3 by(8192.0, -16384.0, 4096.0);
  auto guard = make_motion_constraint(mesh_of(surface), settings());
  auto far_guard = make_motion_constraint(mesh_of(moved(surface, by)), settings());
  Random random(6);
  Differences differences;
  for (const Start& start : starts_on(surface, 20)) {
    Vec3 tip = on_grid(start.tip);
    for (int i = 0; i < 30; ++i) {
      const Vec3 desired = random.uniform(0.1, 0.5) * (start.press + random.direction());
      const Step one = guard.step({.tip = tip, .desired = desired});
      differences.add(one, far_guard.step({.tip = tip + by, .desired = desired}), 1e-6 * radius);
      tip = on_grid(tip + one.motion);
    }
  }
  // Rounding to the grid can move a tip to within rounding of a threshold, where the statuses may
  // differ.
  EXPECT_LE(differences.other_status, is_far ? differences.cycles : differences.cycles / 100);
}

INSTANTIATE_TEST_SUITE_P(Shapes, CertifiedDeterminism, testing::ValuesIn(shapes()), by_name);

}  // namespace
}  // namespace keepout::test::certified_determinism
