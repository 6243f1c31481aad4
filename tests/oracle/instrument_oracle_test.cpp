// SPDX-License-Identifier: BSD-3-Clause
// The judge of whole instruments: its search against a plain loop, and its kinematics against those
// of the library, which it shares nothing with.
#include "keepout/oracle/instrument_oracle.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "by_name.h"
#include "keepout/fixtures/robots.h"
#include "meshes.h"
#include "random_places.h"
#include "trials.h"

namespace keepout::oracle {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A rod that one joint turns about an axis through the origin, and another moves along it.
JudgedRobot rod(double length, double radius) {
  return {.table = {{}, {.slides = true}},
          .bodies = {{{{2}, {2, Vec3(length, 0.0, 0.3 * length)}}, radius}}};
}

double brute_force(const Mesh& mesh, const Segment& axis) {
  double least = infinity;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    least = std::min(least, narrow_distance(axis, mesh.triangle(t)).estimate);
  }
  return least;
}

class InstrumentOracleOnEveryShape : public testing::TestWithParam<Shape> {};

TEST_P(InstrumentOracleOnEveryShape, ClearanceIsThatOfAPlainLoopHoweverItGotThere) {
  const auto mesh = mesh_of(GetParam().make());
  const auto tree = std::make_shared<const TriangleTree>(mesh);
  const double size = mesh->bounds().size().norm();
  Random random(20261123);
  int near = 0;
  for (int path = 0; path < test::trials(3); ++path) {
    const Vec3 place = random_points(*mesh, 1, random).front();
    const double radius = random.uniform(0.0, 0.03) * size;
    const Pose base{
        place, Eigen::AngleAxisd(random.uniform(0.0, 6.0), random.direction()).toRotationMatrix()};
    InstrumentOracle oracle(tree, rod(random.uniform(0.0, 0.3) * size, radius), base);
    std::array<double, 2> q{};
    for (int step = 0; step < 20; ++step) {
      // Small motions, for which it remembers what was near, and a jump now and then.
      const double pace = step % 8 == 7 ? 1.0 : 0.02;
      q[0] += pace * random.uniform(-1.0, 1.0);
      q[1] += pace * random.uniform(-0.3, 0.3) * size;
      oracle.move_to(q);
      const double expected = brute_force(*mesh, oracle.axis(0)) - radius;
      const double reach = expected + random.uniform(-0.1, 0.1) * size;
      const double found = oracle.clearance(0, reach);
      if (reach < expected) {
        EXPECT_EQ(found, infinity);
        continue;
      }
      ++near;
      EXPECT_NEAR(found, expected, 1e-9 * (expected + radius) + 1e-15 * size);
    }
  }
  EXPECT_GT(near, 0);
}

TEST_P(InstrumentOracleOnEveryShape, CollectsAllThatIsWithinOfASegment) {
  const Mesh mesh(GetParam().make());
  const TriangleTree tree(std::make_shared<const Mesh>(mesh));
  const double size = mesh.bounds().size().norm();
  Random random(7);
  for (int i = 0; i < test::trials(10); ++i) {
    const Vec3 place = random_points(mesh, 1, random).front();
    const Segment segment{place, place + random.uniform(0.0, 0.5) * size * random.direction()};
    const double reach = random.uniform(0.0, 0.1) * size;
    std::vector<TriangleId> found;
    tree.collect_within(reach, segment, found);
    std::ranges::sort(found);
    EXPECT_EQ(std::ranges::adjacent_find(found), found.end());
    for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
      if (bracket_distance(segment, mesh.triangle(t)).high > reach) continue;
      ASSERT_TRUE(std::ranges::binary_search(found, t));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(InstrumentOracle, InstrumentOracleOnEveryShape,
                         testing::ValuesIn(shapes()), by_name);

void expect_same_places(const JudgedRobot& judged, Instrument (*make)(const Pose&)) {
  Random random(3);
  for (int i = 0; i < test::trials(1000); ++i) {
    const Pose base{
        200.0 * random.direction(),
        Eigen::AngleAxisd(random.uniform(0.0, 6.0), random.direction()).toRotationMatrix()};
    const Instrument instrument = make(base);
    const Chain& chain = instrument.chain();
    ASSERT_EQ(static_cast<std::size_t>(chain.size()), judged.table.size());
    std::vector<double> q;
    for (int k = 1; k <= chain.size(); ++k) {
      q.push_back(random.uniform(chain.joint(k).limits.lower, chain.joint(k).limits.upper));
    }
    const std::vector<LinkFrame> links = place(judged, chain.base(), q);
    ChainState state;
    chain.forward_kinematics(q, state);
    ASSERT_EQ(instrument.bodies().size(), judged.bodies.size());
    for (std::size_t b = 0; b < judged.bodies.size(); ++b) {
      const Body& body = instrument.bodies()[b];
      const Segment axis = axis_of(judged.bodies[b], links);
      ASSERT_EQ(body.points.size(), 2u);
      EXPECT_EQ(body.radius, judged.bodies[b].radius);
      const Vec3 from = state.at(body.points[0].link, body.points[0].position);
      const Vec3 to = state.at(body.points[1].link, body.points[1].position);
      EXPECT_LE((from - axis.from).norm(), 1e-12 * 2000.0) << body.name;
      EXPECT_LE((to - axis.to).norm(), 1e-12 * 2000.0) << body.name;
    }
    // What is steered is where the last body ends.
    EXPECT_LE((state.flange().position - axis_of(judged.bodies.back(), links).to).norm(),
              1e-12 * 2000.0);
  }
}

TEST(JudgedRobot, ThePsmIsThatOfTheFixtures) { expect_same_places(judged_psm(), &psm); }

TEST(JudgedRobot, TheSevenJointArmIsThatOfTheFixtures) {
  expect_same_places(judged_seven_joint_arm(), &seven_joint_arm);
}

}  // namespace
}  // namespace keepout::oracle
