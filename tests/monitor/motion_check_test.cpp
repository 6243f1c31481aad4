// SPDX-License-Identifier: BSD-3-Clause
// Compares the judge's proofs of whole motions with dense samples of the motion.
#include "keepout/monitor/motion_check.h"

#include <Eigen/Geometry>
#include <cmath>

#include "keepout/oracle/instrument_oracle.h"
#include "keepout/oracle/judged_guide.h"
#include "meshes.h"
#include "trials.h"

namespace keepout::oracle {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Mat3 drawn_rotation(Random& random) {
  return Eigen::AngleAxisd(random.uniform(0.0, 6.0), random.direction()).toRotationMatrix();
}

/// A serial chain of 1 to 8 joints whose links are about `size` long, with a capsule between two of
/// its links, or a blade or ball on one.
JudgedRobot drawn_robot(double size, Random& random) {
  JudgedRobot robot;
  const std::size_t joints = 1 + random.below(8);
  for (std::size_t k = 0; k < joints; ++k) {
    const bool has_axis = random.uniform() < 0.5;
    robot.table.push_back(
        {.slides = random.uniform() < 0.3,
         .a = random.uniform(-0.2, 0.2) * size,
         .alpha_quarters = static_cast<double>(random.below(4)),
         .d = random.uniform(-0.2, 0.2) * size,
         .before = {random.uniform(0.0, 0.2) * size * random.direction(), drawn_rotation(random)},
         .axis = has_axis ? random.direction() : Vec3(Vec3::UnitZ())});
  }
  const auto drawn_point = [&](std::size_t link) {
    return JudgedPoint{static_cast<int>(link),
                       random.uniform(0.0, 0.1) * size * random.direction()};
  };
  JudgedBody body{.points = {}, .radius = random.uniform(0.001, 0.03) * size};
  const std::size_t points = 1 + random.below(5);
  for (std::size_t i = 0; i < points; ++i) {
    body.points.push_back(drawn_point(points == 2 ? random.below(joints + 1) : joints));
  }
  robot.bodies.push_back(body);
  return robot;
}

/// A motion of a drawn robot and of a mesh.
struct Drawn {
  Drawn(double size, double pace, const Vec3& near, Random& random)
      : robot(drawn_robot(size, random)) {
    for (const TableRow& row : robot.table) {
      from.push_back(random.uniform(-3.0, 3.0) * (row.slides ? 0.1 * size : 1.0));
      to.push_back(from.back() +
                   pace * random.uniform(-1.0, 1.0) * (row.slides ? 0.1 * size : 0.2));
    }
    base.rotation = drawn_rotation(random);
    const auto links = place(robot, base, from);
    const JudgedPoint& first = robot.bodies[0].points[0];
    base.position = near - links[static_cast<std::size_t>(first.link)].at(first.position);
    if (random.uniform() < 0.5) {
      meshes[0] = {{random.uniform(0.0, 0.1) * size * random.direction(), drawn_rotation(random)},
                   {pace * random.uniform(0.0, 0.1) * size * random.direction(),
                    pace * random.uniform(0.0, 0.3) * random.direction()}};
    }
  }
  InstrumentMotion motion() const { return {from, to, meshes}; }
  std::vector<double> at(double s) const {
    std::vector<double> q = from;
    for (std::size_t k = 0; k < q.size(); ++k) q[k] += s * (to[k] - from[k]);
    return q;
  }
  /// Returns the pose of link 0 in the frame of the mesh.
  Pose base_at(double s) const {
    const Pose mesh = meshes[0].at(s);
    const Mat3 back = mesh.rotation.transpose();
    return {back * (base.position - mesh.position), back * base.rotation};
  }

  JudgedRobot robot;
  Pose base;
  std::vector<double> from, to;
  std::array<MeshMotion, 1> meshes{};
};

// Differences of neighboring points, for a step h, are at most P h and M h^2 in exact arithmetic.
TEST(Travel, BoundsSpeedAndSecondDerivativeOfRandomChainsAndMeshes) {
  constexpr int steps = 64;
  constexpr double h = 1.0 / steps;
  Random random(1);
  double fastest = 0.0, most_bent = 0.0;
  for (int i = 0; i < test::trials(3000); ++i) {
    const Drawn drawn(1.0, random.uniform(0.01, 3.0), Vec3::Zero(), random);
    const JudgedPoint point{static_cast<int>(drawn.robot.table.size()),
                            random.uniform(0.0, 0.3) * random.direction()};
    std::vector<Vec3> places;
    for (int k = 0; k <= steps; ++k) {
      places.push_back(
          place(drawn.robot, drawn.base_at(k * h), drawn.at(k * h)).back().at(point.position));
    }
    std::vector<JointLine> start, end;
    for (const double s : {0.0, 1.0}) {
      std::vector<JointLine>& joints = s == 0.0 ? start : end;
      const Pose mesh = drawn.meshes[0].at(s);
      const Twist& way = drawn.meshes[0].way;
      joints.push_back({false, way.angular.norm(), mesh.position, way.angular.normalized()});
      joints.push_back({true, way.linear.norm()});
      const auto links = place(drawn.robot, drawn.base, drawn.at(s));
      for (std::size_t k = 0; k < drawn.robot.table.size(); ++k) {
        joints.push_back(
            joint_line(drawn.robot.table[k], links[k + 1], drawn.to[k] - drawn.from[k]));
      }
    }
    const auto world = [&](double s) {
      return place(drawn.robot, drawn.base, drawn.at(s)).back().at(point.position);
    };
    const Travel bound = travel(start, end, world(0.0), world(1.0));
    for (std::size_t k = 1; k < places.size(); ++k) {
      const double way = (places[k] - places[k - 1]).norm();
      ASSERT_LE(way, bound.speed * h * (1.0 + 1e-9) + 1e-14);
      fastest = std::max(fastest, way / (bound.speed * h));
      if (k + 1 == places.size()) break;
      const double bend = (places[k + 1] - 2.0 * places[k] + places[k - 1]).norm();
      ASSERT_LE(bend, bound.bend * h * h * (1.0 + 1e-9) + 1e-14);
      most_bent = std::max(most_bent, bend / (bound.bend * h * h + 1e-14));
    }
  }
  EXPECT_GT(fastest, 0.95);  // the bounds are not far off
  EXPECT_GT(most_bent, 0.9);
}

TEST(Travel, AHeightStaysAboveTheParabola) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const double a = random.uniform(-1.0, 1.0), b = random.uniform(-1.0, 1.0);
    const double bend = random.uniform(0.0, 10.0);
    double least = infinity;
    for (int k = 0; k <= 1000; ++k) {
      const double u = k / 1000.0;
      least = std::min(least, (1.0 - u) * a + u * b - 0.5 * bend * u * (1.0 - u));
    }
    EXPECT_LE(least_between(a, b, bend), least + 1e-15);
    EXPECT_GE(least_between(a, b, bend), least - bend * 1e-6);
  }
}

class MotionCheckOnEveryShape : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(MotionCheck, MotionCheckOnEveryShape, testing::ValuesIn(shapes()),
                         by_name);

// The clearance must be lost if a sample is too close. It must be kept if dense samples leave
// enough for the motion between them.
TEST_P(MotionCheckOnEveryShape, AgreesWithDenseSamples) {
  constexpr int samples = 200;
  const auto mesh = mesh_of(GetParam().make());
  const std::vector<std::shared_ptr<const TriangleTree>> trees{
      std::make_shared<const TriangleTree>(mesh)};
  const double size = mesh->bounds().size().norm();
  Random random(3);
  int decided = 0;
  for (int i = 0; i < test::trials(40); ++i) {
    const Vec3 near = random_points(*mesh, 1, random).front();
    const Drawn drawn(size, std::pow(10.0, random.uniform(-3.0, 0.0)), near, random);
    MotionCheck check(trees, drawn.robot, drawn.base);
    InstrumentOracle oracle(trees[0], drawn.robot, drawn.base_at(0.0));
    double least = infinity, longest = 0.0;
    std::vector<Vec3> last;
    for (int k = 0; k <= samples; ++k) {
      const double s = static_cast<double>(k) / samples;
      oracle.move_to(drawn.at(s), drawn.base_at(s));
      least = std::min(least, oracle.clearance(0, 0.2 * size));
      std::vector<Vec3> points;
      for (const JudgedPoint& point : drawn.robot.bodies[0].points) {
        points.push_back(oracle.links()[static_cast<std::size_t>(point.link)].at(point.position));
      }
      for (std::size_t p = 0; p < last.size(); ++p)
        longest = std::max(longest, (points[p] - last[p]).norm());
      last = points;
    }
    if (least == infinity || !(least > 1e-6 * size - drawn.robot.bodies[0].radius)) continue;
    ++decided;
    const auto at = [&](double due) { return check.check(drawn.motion(), {{due}}).clearance; };
    EXPECT_EQ(at(least + 1e-9 * size), Clearance::lost);
    EXPECT_EQ(at(least - longest - 1e-9 * size), Clearance::kept);
    // Between these, the clearance is lost only if a pose is closer.
    const double due = least - random.uniform(0.0, 0.1) * longest;
    const MotionFinding finding = check.check(drawn.motion(), {{due}});
    if (finding.clearance != Clearance::lost) continue;
    oracle.move_to(drawn.at(finding.at), drawn.base_at(finding.at));
    EXPECT_LT(oracle.clearance(0, 0.2 * size), due + 1e-12 * size);
  }
  EXPECT_GT(decided, 0);
}

// A work budget ends a check, and never lets a motion pass.
TEST_P(MotionCheckOnEveryShape, IsUndecidedWhereItsWorkEnds) {
  const auto mesh = mesh_of(GetParam().make());
  const std::vector<std::shared_ptr<const TriangleTree>> trees{
      std::make_shared<const TriangleTree>(mesh)};
  const double size = mesh->bounds().size().norm();
  Random random(4);
  for (int i = 0; i < test::trials(10); ++i) {
    const Drawn drawn(size, 0.1, random_points(*mesh, 1, random).front(), random);
    MotionCheck check(trees, drawn.robot, drawn.base);
    const double due = random.uniform(0.0, 0.01) * size;
    const Clearance whole = check.check(drawn.motion(), {{due}}).clearance;
    for (std::uint64_t work = 1; work < 1'000'000; work *= 2) {
      const Clearance within = check.check(drawn.motion(), {{due}}, work).clearance;
      EXPECT_TRUE(within == whole || within == Clearance::undecided) << work;
    }
  }
}

TEST(MotionCheck, DecidesNothingAboutNumbersThatAreNotFinite) {
  const std::vector<std::shared_ptr<const TriangleTree>> trees{
      std::make_shared<const TriangleTree>(mesh_of("cube"))};
  const JudgedRobot robot{.table = {{}}, .bodies = {{{{1}}, 0.1}}};
  MotionCheck check(trees, robot, {Vec3(0.0, 0.0, 1e3), Mat3::Identity()});
  const std::array<double, 1> still{0.0}, nan{std::nan("")}, due{0.1};
  const std::array<MeshMotion, 1> mesh{};
  EXPECT_EQ(check.check({still, still, mesh}, due).clearance, Clearance::kept);
  EXPECT_EQ(check.check({still, nan, mesh}, due).clearance, Clearance::undecided);
  EXPECT_EQ(check.check({nan, still, mesh}, due).clearance, Clearance::undecided);
  EXPECT_EQ(check.check({still, still, mesh}, nan).clearance, Clearance::undecided);
  const std::array<MeshMotion, 1> lost{{{{Vec3(nan[0], 0.0, 0.0), Mat3::Identity()}}}};
  EXPECT_EQ(check.check({still, still, lost}, due).clearance, Clearance::undecided);
}

TEST(GuideCheck, AgreesWithDenseSamples) {
  constexpr int samples = 200;
  Random random(5);
  for (int i = 0; i < test::trials(2000); ++i) {
    const Drawn drawn(1.0, std::pow(10.0, random.uniform(-3.0, 0.0)), Vec3::Zero(), random);
    JudgedGuide guide{.kind = static_cast<JudgedGuide::Kind>(random.below(3)),
                      .first = {static_cast<int>(drawn.robot.table.size()), random.direction()},
                      .second = {0, random.direction()},
                      .region = static_cast<JudgedGuide::Region>(random.below(4)),
                      .origin = 0.3 * random.direction(),
                      .direction = random.direction(),
                      .radius = 0.1};
    if (guide.kind != JudgedGuide::Kind::point) guide.region = JudgedGuide::Region::ball;
    double most = -infinity, longest = 0.0, last = 0.0;
    for (int k = 0; k <= samples; ++k) {
      const double s = static_cast<double>(k) / samples;
      const double out = excess(guide, place(drawn.robot, drawn.base, drawn.at(s)));
      most = std::max(most, out);
      if (k > 0) longest = std::max(longest, std::abs(out - last));
      last = out;
    }
    const auto at = [&](double due) {
      return check_guide(guide, drawn.robot, drawn.base, drawn.motion(), due).clearance;
    };
    EXPECT_EQ(at(most - 1e-9), Clearance::lost);
    EXPECT_EQ(at(most + longest + 1e-6), Clearance::kept);
  }
}

}  // namespace
}  // namespace keepout::oracle
