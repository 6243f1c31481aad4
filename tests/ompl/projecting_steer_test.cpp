// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/ompl/projecting_steer.h"

#include <Eigen/Geometry>
#include <stdexcept>

#include "keepout/activation/certified.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/ompl/guard_pool.h"
#include "keepout/ompl/straight_way.h"
#include "keepout/oracle/safety_oracle.h"
#include "meshes.h"
#include "messages.h"
#include "trials.h"

namespace keepout::test::projecting_steer {
namespace {

constexpr double margin = 0.5;
constexpr double tolerance = 1e-6;

using Ending = ProjectingSteer::Ending;

MotionConstraint guard_at(std::string_view shape) {
  return make_motion_constraint(mesh_of(shape), {.options = {.margin = margin}});
}

class SteerOn : public testing::TestWithParam<const char*> {};

TEST_P(SteerOn, EachPieceIsProvenAndComesNearer) {
  const auto mesh = mesh_of(GetParam());
  MotionConstraint guard = guard_at(GetParam());
  ProjectingSteer steer(guard);
  oracle::SafetyOracle oracle(mesh);
  Random random(11);
  const auto starts = random_points(*mesh, 150, random);
  const auto targets = random_points(*mesh, 150, random);
  int arrived = 0, slid = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const double longest = i % 3 == 0 ? 20.0 : 1e3;
    const ProjectingSteer::Way way = steer.steer(starts[i], targets[i], longest);
    ASSERT_FALSE(way.points.empty());
    EXPECT_EQ(way.points.front(), starts[i]);
    EXPECT_LE(way.length, longest * (1.0 + 1e-9));
    if (way.ending == Ending::arrived) {
      EXPECT_EQ(way.points.back(), targets[i]);
    }
    if (way.ending == Ending::not_free) {
      EXPECT_EQ(way.points.size(), 1u);
    }
    double length = 0.0;
    for (std::size_t k = 1; k < way.points.size(); ++k) {
      const Vec3 a = way.points[k - 1], b = way.points[k];
      EXPECT_FALSE(oracle.check(a, b, margin - tolerance).below);
      EXPECT_LT((targets[i] - b).norm(), (targets[i] - a).norm());
      length += (b - a).norm();
      slid += (b - a).cross(targets[i] - a).norm() > 1e-6 * (b - a).norm();
    }
    EXPECT_NEAR(way.length, length, 1e-9);
    arrived += way.ending == Ending::arrived;
  }
  EXPECT_GT(arrived, 5);
  EXPECT_GT(slid, 5);
}

INSTANTIATE_TEST_SUITE_P(Shapes, SteerOn,
                         testing::Values("cube", "sphere", "gear", "thin_plates", "cortex",
                                         "tunnel"),
                         by_name);

TEST(ProjectingSteer, SlidesAroundWhereAStraightMotionIsRefused) {
  MotionConstraint guard = guard_at("sphere");
  const Vec3 from(-60, 0, 20), to(60, 0, 20);
  EXPECT_FALSE(proves(guard, from, to));
  ProjectingSteer steer(guard);
  const auto way = steer.steer(from, to);
  EXPECT_EQ(way.ending, Ending::arrived);
  EXPECT_GT(way.length, 120.0);
}

TEST(ProjectingSteer, EndsAsItSays) {
  MotionConstraint guard = guard_at("cube");
  ProjectingSteer steer(guard, {.most_steps = 40});
  EXPECT_EQ(steer.steer({0, 0, 0}, {0, 0, 60}).ending, Ending::not_free);  // inside
  EXPECT_EQ(steer.steer({0, 0, 60}, {0, 0, -60}).ending, Ending::stuck);   // the cube is in the way
  EXPECT_EQ(steer.steer({0, 0, 60}, {0, 0, 60}).ending, Ending::arrived);  // already there
  EXPECT_EQ(steer.steer({0, 0, 60}, {0, 0, 90}, 10.0).ending, Ending::length);
  EXPECT_EQ(steer.steer({0, 0, 60}, {0, 0, 1e6}).ending, Ending::steps);
  const Box box{{-55, -55, -55}, {55, 55, 55}};
  const auto way = steer.steer({0, 0, 52}, {0, 0, 90}, 1e9, box);
  EXPECT_EQ(way.ending, Ending::unbounded);
  EXPECT_LE(way.points.back().z(), 55.0);
  EXPECT_EQ(steer.steer({0, 0, 60}, {0, 0, 90}, 1e9, box).ending, Ending::not_free);
  EXPECT_EQ(steer.steer({0, 0, 60}, {0, test::nan, 90}).ending, Ending::not_free);
  EXPECT_EQ(steer.steer({0, test::nan, 60}, {0, 0, 90}).ending, Ending::not_free);
  EXPECT_EQ(steer.steer({0, 0, 60}, {0, 0, 90}, test::nan).ending, Ending::length);
}

TEST(ProjectingSteer, RefusesOptionsOutOfRange) {
  MotionConstraint guard = guard_at("cube");
  EXPECT_THROW(ProjectingSteer(guard, {.sliding_step = 5.1}), Error);
  EXPECT_THROW(ProjectingSteer(guard, {.sliding_step = -1.0}), Error);
  EXPECT_THROW(ProjectingSteer(guard, {.least_gain = 1.0}), Error);
  EXPECT_THROW(ProjectingSteer(guard, {.most_steps = 0}), Error);
  EXPECT_CONTAINS(error_of([&] { ProjectingSteer(guard, {.least_gain = -1.0}); }),
                  "least_gain: expected a number from 0 to below 1, got -1");
}

TEST(StraightWay, ASolverThatGivesUpProvesTheSame) {
  for (const char* shape : {"gear", "cortex", "thin_plates"}) {
    const auto mesh = mesh_of(shape);
    MotionConstraint guard = make_motion_constraint(
        mesh, {.options = {.margin = margin}, .inside = Inside::taken_as_is});
    MotionConstraint quick(mesh, make_index("wide_bvh", mesh), std::make_unique<CertifiedRule>(),
                           std::make_unique<StraightOnly>(), {.radius = 5.0, .margin = margin});
    Random random(4);
    const auto from = random_points(*mesh, 400, random);
    const auto to = random_points(*mesh, 400, random);
    for (std::size_t i = 0; i < from.size(); ++i) {
      EXPECT_EQ(proves(guard, from[i], to[i]), proves(quick, from[i], to[i]));
    }
  }
}

TEST(StraightWay, AbsurdWaysAreRefusedInNoTime) {
  MotionConstraint guard = guard_at("cube");
  const double huge = std::numeric_limits<double>::max();
  EXPECT_FALSE(proves(guard, {0, 0, 60}, {0, 0, huge}));
  EXPECT_FALSE(proves(guard, {0, 0, -huge}, {0, 0, huge}));
  EXPECT_FALSE(proves(guard, {0, 0, 60}, {0, 0, test::nan}));
  EXPECT_EQ(proven_prefix(guard, {0, 0, 60}, {0, 0, huge}).fraction, 0.0);
}

TEST(GuardPool, MakesOneAtOnceAndNoMoreThanItMay) {
  int made = 0;
  GuardPool pool(
      [&] {
        // The second guard cannot be made: its borrower waits for the first.
        if (++made == 2) throw std::runtime_error("no memory");
        return guard_at("cube");
      },
      8);
  EXPECT_EQ(pool.made(), 1u);
  EXPECT_EQ(pool.options().margin, margin);
  GuardPool unbounded([&] { return guard_at("cube"); }, std::numeric_limits<std::size_t>::max());
  const GuardPool::Loan one = unbounded.borrow(), other = unbounded.borrow();
  EXPECT_EQ(unbounded.made(), 2u);
  EXPECT_THROW(GuardPool({}, 1), Error);
  EXPECT_THROW(GuardPool([&] { return guard_at("cube"); }, 0), Error);
  EXPECT_THROW(GuardPool([&] {
                 return make_motion_constraint(mesh_of("cube"), {.options = {.margin = -1.0}});
               }),
               Error);
}

}  // namespace
}  // namespace keepout::test::projecting_steer
