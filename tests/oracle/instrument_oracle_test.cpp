// SPDX-License-Identifier: BSD-3-Clause
// Compares the oracle of whole instruments with references: its search with a plain loop, and its
// kinematics with the library's, with which it shares no code.
#include "keepout/oracle/instrument_oracle.h"

#include <Eigen/Geometry>

#include "keepout/fixtures/robots.h"
#include "keepout/geometry/region.h"
#include "keepout/oracle/judged_guide.h"
#include "meshes.h"
#include "trials.h"

namespace keepout::oracle {
namespace {

/// Draws a rod, or a blade of 3 to 8 points, that one joint turns about an axis through the origin
/// and another moves along it.
JudgedRobot drawn_robot(bool is_blade, double size, Random& random) {
  JudgedBody body{.points = {}, .radius = random.uniform(0.0, is_blade ? 0.01 : 0.03) * size};
  if (is_blade) {
    const double extent = random.uniform(0.005, 0.05) * size;
    for (std::size_t i = 0, count = 3 + random.below(6); i < count; ++i) {
      body.points.push_back({2, extent * random.uniform() * random.direction()});
    }
  } else {
    const double length = random.uniform(0.0, 0.3) * size;
    body.points = {{2}, {2, Vec3(length, 0.0, 0.3 * length)}};
  }
  return {.table = {{}, {.slides = true}}, .bodies = {body}};
}

/// Returns the distance of the convex hull of points on a link from a mesh, by a plain loop.
double brute_force(const Mesh& mesh, const JudgedBody& body, const LinkFrame& link) {
  std::vector<Vec3> points;
  for (const JudgedPoint& point : body.points) points.push_back(link.at(point.position));
  const Hull hull(points);
  double least = test::infinity;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle triangle = mesh.triangle(t);
    if (points.size() == 2) {
      least = std::min(least, narrow_distance({points[0], points[1]}, triangle).estimate);
      continue;
    }
    const double far =
        std::max((triangle[1] - triangle[0]).norm(), (triangle[2] - triangle[0]).norm());
    if (hull.least_distance(triangle[0]) - far > least) continue;
    least = std::min(least, hull.distance(triangle, narrow_distance).estimate);
  }
  return least;
}

class InstrumentOracleOnEveryShape : public testing::TestWithParam<Shape> {};

TEST_P(InstrumentOracleOnEveryShape, ClearanceIsThatOfAPlainLoopHoweverItGotThere) {
  const auto mesh = mesh_of(GetParam().make());
  const auto tree = std::make_shared<const TriangleTree>(mesh);
  const double size = mesh->bounds().size().norm();
  Random random(20261123);
  std::array<int, 2> near{};  // of rods, and of blades
  for (int path = 0; path < 2 * test::trials(3); ++path) {
    const bool is_blade = path % 2 == 1;
    const JudgedRobot robot = drawn_robot(is_blade, size, random);
    const double radius = robot.bodies[0].radius;
    const Pose base{
        random_points(*mesh, 1, random).front(),
        Eigen::AngleAxisd(random.uniform(0.0, 6.0), random.direction()).toRotationMatrix()};
    InstrumentOracle oracle(tree, robot, base);
    std::array<double, 2> q{};
    for (int step = 0; step < 20; ++step) {
      // In small motions the oracle reuses the near triangles of the last step. Sometimes the
      // instrument jumps.
      const double pace = step % 8 == 7 ? 1.0 : 0.02;
      q[0] += pace * random.uniform(-1.0, 1.0);
      q[1] += pace * random.uniform(-0.3, 0.3) * size;
      oracle.move_to(q);
      const double expected = brute_force(*mesh, robot.bodies[0], oracle.links()[2]) - radius;
      const double reach = expected + random.uniform(-0.1, 0.1) * size;
      const double found = oracle.clearance(0, reach);
      if (reach < expected) {
        EXPECT_EQ(found, test::infinity);
        continue;
      }
      ++near[is_blade ? 1 : 0];
      const double rounding = (is_blade ? 1e-14 : 1e-15) * size;
      EXPECT_NEAR(found, expected, 1e-9 * (expected + radius) + rounding);
    }
  }
  EXPECT_GT(near[0], 0);
  EXPECT_GT(near[1], 0);
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
    // The flange, which a step moves, is at the end of the last body.
    EXPECT_LE((state.flange().position - axis_of(judged.bodies.back(), links).to).norm(),
              1e-12 * 2000.0);
  }
}

TEST(JudgedRobot, ThePsmIsThatOfTheFixtures) { expect_same_places(judged_psm(), &psm); }

TEST(JudgedRobot, TheSevenJointArmIsThatOfTheFixtures) {
  expect_same_places(judged_seven_joint_arm(), &seven_joint_arm);
}

// Compares the judge's regions with values computed by hand and with the library's, which share no
// code with them.

using Kind = JudgedGuide::Kind;
using Region = JudgedGuide::Region;

std::vector<LinkFrame> world() { return place({}, {}, {}); }

TEST(JudgedGuide, RegionsAreWhatTheyAreByHand) {
  const JudgedGuide slab{.first = {0, Vec3(5.0, 7.0, 1.0)},
                         .region = Region::slab,
                         .direction = Vec3::UnitX(),
                         .radius = 2.0};
  EXPECT_DOUBLE_EQ(excess(slab, world()), 3.0);
  JudgedGuide half_space = slab;
  half_space.region = Region::half_space;
  half_space.radius = 0.0;
  EXPECT_DOUBLE_EQ(excess(half_space, world()), -5.0);
  JudgedGuide tube = slab;
  tube.region = Region::tube;
  EXPECT_DOUBLE_EQ(excess(tube, world()), std::sqrt(50.0) - 2.0);
  JudgedGuide ball = slab;
  ball.region = Region::ball;
  EXPECT_DOUBLE_EQ(excess(ball, world()), std::sqrt(75.0) - 2.0);
}

TEST(JudgedGuide, AxesAndShaftsAreWhatTheyAreByHand) {
  const double angle = 0.3;
  const JudgedGuide axis{.kind = Kind::axis,
                         .first = {0, Vec3(std::cos(angle), std::sin(angle), 0.0)},
                         .origin = Vec3::UnitX(),
                         .radius = 2.0 * std::sin(0.05)};
  EXPECT_DOUBLE_EQ(excess(axis, world()), 2.0 * std::sin(0.15) - 2.0 * std::sin(0.05));
  JudgedGuide shaft{.kind = Kind::remote_center,
                    .first = {0, Vec3(0.0, 0.0, 0.0)},
                    .second = {0, Vec3(10.0, 0.0, 0.0)},
                    .origin = Vec3(4.0, 3.0, 0.0),
                    .radius = 1.0};
  EXPECT_DOUBLE_EQ(excess(shaft, world()), 2.0);
  shaft.origin = Vec3(13.0, 4.0, 0.0);  // beyond its end
  EXPECT_DOUBLE_EQ(excess(shaft, world()), 4.0);
}

TEST(JudgedGuide, ExcessIsThatOfTheLibrary) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 origin = random.uniform(0.0, 10.0) * random.direction();
    const Vec3 direction = random.direction();
    const double radius = random.uniform(0.1, 5.0);
    const Vec3 point = random.uniform(0.0, 10.0) * random.direction();
    JudgedGuide judged{
        .first = {0, point}, .origin = origin, .direction = direction, .radius = radius};
    const auto expect = [&](Region kind, const keepout::Region& region) {
      judged.region = kind;
      EXPECT_NEAR(excess(judged, world()), region.excess(point), 1e-13);
    };
    expect(Region::slab, keepout::Region::slab(origin, direction, radius));
    expect(Region::tube, keepout::Region::tube(origin, direction, radius));
    expect(Region::ball, keepout::Region::ball(origin, radius));
    judged.radius = 0.0;
    expect(Region::half_space, keepout::Region::half_space(origin, direction));
  }
}

}  // namespace
}  // namespace keepout::oracle
