// SPDX-License-Identifier: BSD-3-Clause
// Robots from a URDF and a file of bodies, and bodies that enclose collision elements.

#include "keepout/urdf/read_robot.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "enclosing_capsule.h"
#include "keepout/fixtures/random.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/oracle/distance.h"
#include "messages.h"
#include "temporary_folder.h"
#include "trials.h"

namespace keepout {
namespace {

const std::string robots = KEEPOUT_ROBOTS;
using Real = long double;
using Point = Eigen::Matrix<Real, 3, 1>;
using Turn = Eigen::Matrix<Real, 3, 3>;

/// The pose of an <origin>, computed in long double, independently of the reader.
struct Origin {
  Point at = Point::Zero();
  Turn turn = Turn::Identity();

  Origin operator*(const Origin& inner) const { return {at + turn * inner.at, turn * inner.turn}; }
};
Origin origin(Real x, Real y, Real z, Real roll = 0, Real pitch = 0, Real yaw = 0) {
  const auto about = [](int axis, Real angle) {
    Turn turn = Turn::Identity();
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    turn(u, u) = turn(v, v) = std::cos(angle);
    turn(v, u) = std::sin(angle);
    turn(u, v) = -std::sin(angle);
    return turn;
  };
  return {Point(x, y, z), about(2, yaw) * about(1, pitch) * about(0, roll)};
}

/// Returns how far a point is outside of a body on one link, by exact arithmetic; 0 inside. [mm]
double outside(const Body& body, const Vec3& point) {
  const monitor::Segment core{body.points.front().position, body.points.back().position};
  const auto exact = oracle::exact_distance(core, {point, point, point}, body.radius);
  return exact.against_threshold > 0 ? exact.distance - body.radius : 0.0;
}

/// Fails unless a body contains a point of a shape, given in meters.
void expect_inside(const Body& body, const Origin& shape, const Point& meters) {
  const Vec3 point = (1000 * (shape.at + shape.turn * meters)).cast<double>();
  EXPECT_EQ(outside(body, point), 0.0) << body.name << ": " << point.transpose();
}

/// Fails unless a body contains a cylinder about z, or its ends are half balls: a capsule.
void expect_cylinder_inside(const Body& body, const Origin& shape, Real radius, Real length,
                            bool has_round_ends) {
  constexpr int around = 90;
  for (int i = 0; i < around; ++i) {
    const Real angle = 2 * std::numbers::pi_v<Real> * i / around;
    const Point side(radius * std::cos(angle), radius * std::sin(angle), 0);
    for (const Real end : {-length / 2, length / 2}) {
      expect_inside(body, shape, side + Point(0, 0, end));
      for (int j = 1; has_round_ends && j <= 9; ++j) {
        const Real up = std::numbers::pi_v<Real> * j / 18;
        expect_inside(
            body, shape,
            std::cos(up) * side + Point(0, 0, end + std::copysign(radius, end) * std::sin(up)));
      }
    }
  }
}

const Body& body_named(const UrdfRobot& robot, const std::string& name) {
  for (const Body& body : robot.instrument.bodies()) {
    if (body.name == name) return body;
  }
  ADD_FAILURE() << "there is no body " << name;
  return robot.instrument.bodies().front();
}

TEST(ReadRobot, EachBodyContainsTheShapeForWhichItStands) {
  const UrdfRobot robot = read_robot(robots + "/six_joint_arm.urdf", "", "base_link", "tip");
  EXPECT_EQ(robot.name, "six_joint_arm");
  const auto bodies = robot.instrument.bodies();
  ASSERT_EQ(bodies.size(), 7u);
  const auto link_of = [&](const char* name) { return body_named(robot, name).points[0].link; };
  EXPECT_EQ(link_of("base_link"), 0);
  EXPECT_EQ(link_of("upper_arm"), 2);
  EXPECT_EQ(link_of("holder"), 6);

  expect_cylinder_inside(body_named(robot, "base_link"), origin(0, 0, .05L), .06L, .1L, false);
  const Body& ball = body_named(robot, "shoulder");
  EXPECT_EQ(ball.points.size(), 1u);
  EXPECT_GE(ball.radius, 65.0);
  EXPECT_LT(ball.radius, 65.0 + 1e-9);
  expect_cylinder_inside(ball, origin(0, 0, 0), .065L, 0, true);
  const Body& capsule = body_named(robot, "upper_arm");
  EXPECT_LT(capsule.radius, 45.0 + 1e-9) << "a capsule stays one";
  expect_cylinder_inside(capsule, origin(0, 0, .15L), .045L, .3L, true);
  expect_cylinder_inside(body_named(robot, "forearm"), origin(0, 0, .13L), .035L, .22L, false);
  for (int corner = 0; corner < 8; ++corner) {
    expect_inside(body_named(robot, "wrist_2"), origin(0, 0, .03L, 0, 0, .3L),
                  {(corner & 1) ? .025L : -.025L, (corner & 2) ? .03L : -.03L,
                   (corner & 4) ? .045L : -.045L});
  }
  const Origin drill = origin(0, 0, .02L, 0, 0, 1.5707963267948966L);
  const auto mesh =
      load_mesh(robots + "/six_joint_arm_holder.obj", {.check = MeshCheck::none}).mesh;
  ASSERT_EQ(mesh->vertex_count(), 21u);
  for (const Vec3& vertex : mesh->vertices()) {
    expect_inside(body_named(robot, "holder"), drill, vertex.cast<Real>() / 1000);
  }
  expect_cylinder_inside(bodies.back(), drill * origin(0, 0, .12L), .002L, .16L, false);
  EXPECT_EQ(bodies.back().name, "bit") << "the tool is the last body";
  const Pose& flange = robot.instrument.chain().flange();
  EXPECT_LT((bodies.back().points.back().position - flange.position).norm(), 1e-12)
      << "and ends in the tip";
  ASSERT_EQ(robot.notices.size(), 1u);
  EXPECT_CONTAINS(robot.notices[0],
                  "link 'wrist_1' has no collision element: nothing of it is guarded");
}

/// Returns a cloud of points: flat, thin or round, and maybe far away.
std::vector<Vec3> cloud(Random& random) {
  std::vector<Vec3> points;
  const Vec3 size(std::pow(10.0, random.uniform(-3.0, 2.0)),
                  std::pow(10.0, random.uniform(-3.0, 2.0)), random.uniform() < 0.3 ? 0.0 : 10.0);
  const Mat3 turn =
      Eigen::AngleAxisd(random.uniform(0.0, 3.0), random.direction()).toRotationMatrix();
  const Vec3 at = (random.uniform() < 0.5 ? 10.0 : 1e4) * random.direction();
  for (std::size_t i = 0, count = 1 + random.below(40); i < count; ++i) {
    points.push_back(at + turn * size.cwiseProduct(random.uniform() * random.direction()));
  }
  if (random.uniform() < 0.1) points.assign(points.size(), points.front());
  return points;
}

TEST(EnclosingCapsule, ContainsEachPointExactly) {
  Random random(20261127);
  const int count = test::trials(2000);
  for (int i = 0; i < count; ++i) {
    const std::vector<Vec3> points = cloud(random);
    const Capsule capsule = enclosing_capsule(points);
    Vec3 mean = Vec3::Zero();
    for (const Vec3& point : points) mean += point / static_cast<double>(points.size());
    double ball = 0.0;
    for (const Vec3& point : points) {
      const auto exact =
          oracle::exact_distance({capsule.from, capsule.to}, {point, point, point}, capsule.radius);
      ASSERT_TRUE(exact.against_threshold <= 0)
          << i << ": " << exact.distance << " " << capsule.radius;
      ball = std::max(ball, (point - mean).norm());
    }
    // The ball around the mean is one of the worst enclosures.
    EXPECT_LE(capsule.radius, 1.0001 * ball + 1e-7) << i;
  }
}

TEST(EnclosingCapsule, IsTightAroundACapsule) {
  std::vector<Vec3> points;
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (int i = 0; i < 60; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 60;
    for (const double z : {-40.0, 0.0, 40.0})
      points.push_back(turn * Vec3(5 * std::cos(angle), 5 * std::sin(angle), z));
    points.push_back(turn * Vec3(0, 0, i % 2 == 0 ? 45.0 : -45.0));
  }
  const Capsule capsule = enclosing_capsule(points);
  EXPECT_NEAR(capsule.radius, 5.0, 0.4);
  EXPECT_NEAR((capsule.to - capsule.from).norm(), 80.0, 2.0);
}

TEST(ReadRobot, TheBodiesOfAFileAreInTheFramesOfTheirLinks) {
  const UrdfRobot robot =
      read_robot(robots + "/six_joint_arm.urdf", robots + "/six_joint_arm.json");
  const auto bodies = robot.instrument.bodies();
  ASSERT_EQ(bodies.size(), 5u);
  EXPECT_TRUE(robot.notices.empty());
  EXPECT_EQ(robot.links, (std::vector<std::string>{"base_link", "shoulder", "upper_arm", "forearm",
                                                   "wrist_1", "wrist_2", "wrist_3"}));
  EXPECT_EQ(robot.instrument.chain().base().position, Vec3(0, 0, 200));
  EXPECT_EQ(bodies[1].name, "forearm");
  EXPECT_EQ(bodies[1].radius, 36.0);
  EXPECT_EQ(bodies[1].points[0].link, 3);
  EXPECT_EQ(bodies[1].points[1].link, 4) << "a body from link to link";
  EXPECT_EQ(bodies[4].points[1].link, 6) << "'tip' is fixed to wrist_3";
  EXPECT_LT((bodies[4].points[1].position - Vec3(0, 0, 220)).norm(), 1e-12);
  const UrdfRobot meters =
      read_robot(robots + "/six_joint_arm.urdf", robots + "/six_joint_arm.json", "", "", 1.0);
  EXPECT_DOUBLE_EQ(meters.instrument.bodies()[1].radius, 0.036);
  EXPECT_LT((meters.instrument.bodies()[4].points[1].position - Vec3(0, 0, 0.22)).norm(), 1e-15);
  EXPECT_EQ(meters.instrument.chain().base().position, Vec3(0, 0, 0.2));
}

class FaultyRobot : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    return folder_.write(name, text).string();
  }
  std::string arm_with(const std::string& collision, const std::string& more = "") const {
    return write("arm.urdf", R"(<robot name="arm"><link name="base"/><link name="rod">)" +
                                 collision +
                                 R"(</link><link name="tip"/><joint name="slide" type="prismatic">
      <parent link="base"/><child link="rod"/><limit lower="0" upper="0.1" velocity="1" effort="1"/></joint>
      <joint name="end" type="fixed"><parent link="rod"/><child link="tip"/></joint>)" +
                                 more + "</robot>");
  }
  void expect_shape_refused(const std::string& geometry, const std::string& words) const {
    const std::string urdf = arm_with("<collision>" + geometry + "</collision>");
    const std::string said = error_of([&] { read_robot(urdf, "", "", "tip"); });
    EXPECT_TRUE(said.starts_with(urdf + ": ")) << said;
    EXPECT_CONTAINS(said, words);
  }
  void expect_bodies_refused(const std::string& json, const std::string& words) const {
    const std::string urdf = arm_with("");
    const std::string bodies = write("bodies.json", json);
    const std::string said = error_of([&] { read_robot(urdf, bodies); });
    EXPECT_TRUE(said.starts_with(bodies + ": ")) << said;
    EXPECT_CONTAINS(said, words);
  }
  TemporaryFolder folder_;
};

TEST_F(FaultyRobot, EachFaultOfAShapeHasAMessageOfItsOwn) {
  const auto geometry = [](const std::string& form) { return "<geometry>" + form + "</geometry>"; };
  expect_shape_refused(geometry("<capsule radius='nan' length='1'/>"), "nan");
  expect_shape_refused(geometry("<capsule radius='1'/>"), "length");
  expect_shape_refused(geometry("<sphere radius='-1'/>"),
                       "link 'rod', collision 1 has a negative <sphere radius>");
  expect_shape_refused(geometry("<sphere radius='1e999'/>"), "1e999");
  expect_shape_refused(geometry("<box size='1 1 inf'/>"), "inf");
  expect_shape_refused(geometry("<box size='1 -1 1'/>"), "has a negative <box size>");
  expect_shape_refused(
      "<origin xyz='0 0 0'/><origin xyz='1 0 0'/>" + geometry("<sphere radius='1'/>"),
      "has <origin> twice");
  expect_shape_refused(geometry("<sphere radius='1e20'/>"),
                       "the radius of body 1 ('rod') must be a length");
  expect_shape_refused(geometry("<mesh filename='none.stl'/>"), "there is no file");
  expect_shape_refused(geometry("<mesh filename='package://none/a.stl'/>"),
                       "none/a.stl: name one beside");
  expect_shape_refused(geometry("<mesh filename='http://x/a.stl'/>"),
                       "is not a file: write its path");
  write("broken.stl", "solid a\nfacet normal 0 0 1\n");
  expect_shape_refused(geometry("<mesh filename='broken.stl'/>"), "link 'rod', collision 1: ");
  expect_shape_refused(geometry("<mesh filename='broken.stl'/>"), "broken.stl: ");
  write("shape.dae", "<COLLADA/>");
  expect_shape_refused(geometry("<mesh filename='shape.dae'/>"), "shape.dae: ");
  std::string many;
  for (int i = 0; i < 17; ++i)
    many += "<collision>" + geometry("<sphere radius='0.1'/>") + "</collision>";
  const std::string urdf = arm_with(many);
  EXPECT_CONTAINS(error_of([&] { read_robot(urdf, "", "", "tip"); }),
                  "17 collision elements, not 1 to 16: write");
  const std::string none = arm_with("");
  EXPECT_CONTAINS(error_of([&] { read_robot(none, "", "", "tip"); }), "0 collision elements");
}

TEST_F(FaultyRobot, AShapeThatAnotherJointMovesIsRefusedAndOneBesideTheArmIsReported) {
  const std::string ball = "<collision><geometry><sphere radius='0.1'/></geometry></collision>";
  const std::string finger =
      R"(<link name="finger">)" + ball + R"(</link><joint name="grip" type="continuous">
    <parent link="rod"/><child link="finger"/></joint>)";
  const std::string urdf = arm_with(ball, finger);
  const std::string said = error_of([&] { read_robot(urdf, "", "", "tip"); });
  EXPECT_CONTAINS(said,
                  "link 'finger', collision 1 moves with joint 'grip', which is not in the chain");
  const std::string table =
      R"(<link name="table">)" + ball + R"(</link><joint name="stand" type="fixed">
    <parent link="table"/><child link="base"/></joint>)";
  const UrdfRobot robot = read_robot(arm_with(ball, table), "", "base", "tip");
  EXPECT_EQ(robot.instrument.bodies().size(), 1u);
  ASSERT_EQ(robot.notices.size(), 1u);
  EXPECT_CONTAINS(robot.notices[0], "link 'table' is not on the way from 'base' to the tip");
}

TEST_F(FaultyRobot, EachFaultOfAFileOfBodiesHasAMessageOfItsOwn) {
  const std::string good = R"({"link":"rod","xyz_mm":[0,0,0]})";
  const auto body = [](const std::string& members) { return R"({"bodies":[{)" + members + "}]}"; };
  const auto with_point = [&](const std::string& point) {
    return body(R"("name":"a","radius_mm":1,"points":[)" + point + "]");
  };
  EXPECT_EQ(error_of([&] { read_robot(arm_with(""), write("bodies.json", with_point(good))); }),
            "no error");
  expect_bodies_refused("", "cannot read it, or it is empty; name a file of JSON");
  expect_bodies_refused("{", "is not JSON: line 1, column 2");
  expect_bodies_refused("[]",
                        "the file must be an object with base, tip, base_pose, bodies, not []");
  expect_bodies_refused(R"({"bodys":[]})",
                        R"(the file has an unknown field "bodys"; did you mean "bodies"?)");
  expect_bodies_refused(R"({"tip":"tip","tip":"rod"})", R"(the field "tip" is given twice)");
  expect_bodies_refused(R"({"bodies":[]})", "bodies must be an array of 1 to 16, and has 0");
  expect_bodies_refused(R"({"bodies":{}})", "bodies must be an array of 1 to 16, not {}");
  std::string many;
  for (int i = 0; i < 17; ++i) many += std::string(i > 0 ? "," : "") + "{}";
  expect_bodies_refused(R"({"bodies":[)" + many + "]}",
                        "bodies must be an array of 1 to 16, and has 17");
  expect_bodies_refused(body(""), R"(bodies[0] has no "name": write a name)");
  expect_bodies_refused(body(R"("name":"a b")"), "bodies[0].name may have letters, digits");
  expect_bodies_refused(body(R"("name":"a","radius":1)"),
                        R"(unknown field "radius"; did you mean "radius_mm"?)");
  expect_bodies_refused(body(R"("name":"a","radius_mm":-1)"),
                        "bodies[0].radius_mm must be a number of at least 0");
  expect_bodies_refused(body(R"("name":"a","radius_mm":"1")"), R"(in mm, not "1")");
  expect_bodies_refused(body(R"("name":"a","radius_mm":1e999)"), "is not JSON: ");
  expect_bodies_refused(body(R"("name":"a","radius_mm":NaN)"), "is not JSON: ");
  expect_bodies_refused(body(R"("name":"a","radius_mm":1)"), R"(bodies[0] has no "points")");
  expect_bodies_refused(with_point(""), "bodies[0].points must be an array of 1 to 8, and has 0");
  expect_bodies_refused(with_point(R"({"link":"rod"})"),
                        R"(points[0] has no "xyz_mm": write [x, y, z])");
  expect_bodies_refused(with_point(R"({"link":"rod","xyz_mm":[0,0]})"),
                        "points[0].xyz_mm must be an array of three");
  expect_bodies_refused(with_point(R"({"link":"rod","xyz_mm":[0,0,null]})"),
                        "three finite numbers, not [0,0,null]");
  expect_bodies_refused(with_point(R"({"link":"rot","xyz_mm":[0,0,0]})"),
                        "bodies[0].points[0].link: there is no link 'rot'; did you mean 'rod'?");
  expect_bodies_refused(
      R"({"tip":"rod","base":"rod","bodies":[{"name":"a","radius_mm":1,"points":[]}]})",
      "bodies[0].points must be an array of 1 to 8");
  expect_bodies_refused(R"({"bodies":[{"name":"a","radius_mm":1,"points":[)" + good +
                            R"(]},{"name":"a","radius_mm":1,"points":[)" + good + "]}]}",
                        "bodies[1].name is the name of another body");
  expect_bodies_refused(R"({"base_pose":{"xyz_m":[0,0,0]}})",
                        R"(base_pose has an unknown field "xyz_m")");
  expect_bodies_refused(std::string(100, '['), "nested more deeply");
  expect_bodies_refused(std::string((1 << 20) + 1, ' '), "is larger than 1 MiB");
}

TEST_F(FaultyRobot, FilesThatAreNoneAreNamed) {
  const std::string urdf = arm_with("");
  EXPECT_CONTAINS(error_of([&] { read_robot(urdf, folder_.path() / "none.json"); }),
                  "none.json: cannot read it");
  EXPECT_CONTAINS(error_of([&] { read_robot(urdf, folder_.path()); }),
                  "is a directory; name a JSON file in it");
  EXPECT_CONTAINS(error_of([&] { read_robot(urdf, "/dev/null"); }), "is not a regular file");
  EXPECT_CONTAINS(error_of([&] { read_robot(folder_.path() / "none.urdf"); }),
                  "none.urdf: cannot read it");
  const std::string tip = write("tip.json", R"({"tip":"tup"})");
  EXPECT_CONTAINS(error_of([&] { read_robot(urdf, tip); }),
                  "there is no link 'tup'; did you mean 'tip'?");
}

TEST_F(FaultyRobot, AChangedFileOfBodiesIsRefusedOrReadAndNeverCrashes) {
  const std::string good = contents_of(robots + "/six_joint_arm.json");
  Random random(7);
  const int count = test::trials(1000);
  int refused = 0;
  for (int i = 0; i < count; ++i) {
    std::string text = good;
    for (std::size_t k = 0; k <= random.below(4); ++k) {
      text[random.below(text.size())] = static_cast<char>(random.below(256));
    }
    const std::string said =
        error_of([&] { read_robot(robots + "/six_joint_arm.urdf", write("changed.json", text)); });
    refused += said == "no error" ? 0 : 1;
  }
  EXPECT_GT(refused, count / 2);
}

}  // namespace
}  // namespace keepout
