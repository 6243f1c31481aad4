// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/robots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "keepout/error.h"
#include "keepout/fixtures/robots.h"
#include "keepout/robot/denavit_hartenberg.h"
#include "shared/progress.h"
#include "shared/robot_file.h"
#if KEEPOUT_HAS_URDF
#include "keepout/urdf/read_robot.h"
#endif

namespace keepout::app {
namespace {

constexpr double turning_velocity = 1.0;   // [rad/s]
constexpr double sliding_velocity = 25.0;  // [mm/s]

/// A drawn robot: table and bodies in the form of the judge, and the limits that the library needs
/// in addition.
struct Drawn {
  monitor::JudgedRobot judged;
  std::vector<JointLimits> limits;
};

Body body_of(const monitor::JudgedBody& judged) {
  Body body{.name = "body", .radius = judged.radius};
  for (const monitor::JudgedPoint& point : judged.points) {
    body.points.push_back({point.link, point.position});
  }
  return body;
}

RobotUnderTest robot_of(Drawn drawn) {
  constexpr double right = std::numbers::pi / 2.0;
  RobotUnderTest robot{.name = "drawn", .description = ""};
  std::vector<DenavitHartenberg> table;
  for (std::size_t k = 0; k < drawn.judged.table.size(); ++k) {
    const monitor::TableRow& row = drawn.judged.table[k];
    const JointLimits& limits = drawn.limits[k];
    table.push_back({.name = "joint",
                     .kind = row.slides ? JointKind::prismatic : JointKind::revolute,
                     .a = row.a,
                     .alpha = right * row.alpha_quarters,
                     .d = row.d,
                     .theta = right * row.theta_quarters,
                     .limits = limits});
    const double middle = 0.5 * (limits.lower + limits.upper);
    const double half = 0.3 * (limits.upper - limits.lower);
    robot.starts.push_back({middle - half, middle + half});
  }
  robot.joints = joints_of(table, DhConvention::modified).joints;
  robot.flange.position = drawn.judged.bodies.back().points.back().position;
  for (const monitor::JudgedBody& body : drawn.judged.bodies) robot.bodies.push_back(body_of(body));
  robot.model = std::move(drawn.judged);
  return robot;
}

/// Returns the joints of a chain, with normalized rotations and axes.
std::vector<Joint> all_joints(const Chain& chain) {
  std::vector<Joint> joints;
  for (int k = 1; k <= chain.size(); ++k) joints.push_back(chain.joint(k));
  return joints;
}

RobotUnderTest known_robot(std::string name, std::string description, const Instrument& instrument,
                           monitor::JudgedRobot model, std::vector<RobotUnderTest::Range> starts) {
  return {std::move(name),
          std::move(description),
          all_joints(instrument.chain()),
          instrument.chain().flange(),
          {instrument.bodies().begin(), instrument.bodies().end()},
          std::move(model),
          std::move(starts)};
}

#if KEEPOUT_HAS_URDF
constexpr double widest_start = 1.0;  // [rad]

/// Returns the start range of a joint.
RobotUnderTest::Range start_of(const Joint& joint) {
  const JointLimits& limits = joint.limits;
  if (!std::isfinite(limits.upper - limits.lower)) return {-widest_start, widest_start};
  const double middle = 0.5 * (limits.lower + limits.upper);
  double half = 0.3 * (limits.upper - limits.lower);
  if (joint.kind == JointKind::revolute) half = std::min(half, widest_start);
  return {middle - half, middle + half};
}
#endif

/// Returns the robot of a URDF file. The judge's kinematics are its own, and its data are those of
/// the chain, because the robot has no table.
RobotUnderTest robot_of_files([[maybe_unused]] const std::string& urdf,
                              [[maybe_unused]] const std::filesystem::path& bodies) {
#if KEEPOUT_HAS_URDF
  const UrdfRobot read = read_robot(urdf, bodies);
  for (const std::string& notice : read.notices) warn_on_stderr(notice);
  RobotUnderTest robot = known_robot(urdf, "", read.instrument, {}, {});
  for (const Joint& joint : robot.joints) {
    robot.model.table.push_back(
        {.slides = joint.kind == JointKind::prismatic, .before = joint.origin, .axis = joint.axis});
    robot.starts.push_back(start_of(joint));
  }
  for (const Body& body : robot.bodies) {
    monitor::JudgedBody& judged = robot.model.bodies.emplace_back();
    judged.radius = body.radius;
    for (const LinkPoint& point : body.points)
      judged.points.push_back({point.link, point.position});
  }
  return robot;
#else
  throw Error("--robot: " + urdf +
              ": this build reads no URDF: install liburdfdom-dev and liburdfdom-headers-dev, and "
              "build it again");
#endif
}

JointLimits turning(double range) {
  return {.lower = -range, .upper = range, .velocity = turning_velocity};
}
JointLimits sliding(double range) {
  return {.lower = -range, .upper = range, .velocity = sliding_velocity};
}

double drawn_radius(Random& random) {
  return random.uniform() < 0.2 ? 0.0 : random.uniform(0.05, 3.0);
}

/// Returns a body of points around a place of a link; the last point is the place itself. Half of
/// the bodies are flat.
monitor::JudgedBody blade_at(int link, const Vec3& place, double size, Random& random) {
  monitor::JudgedBody blade{.points = {}, .radius = 0.3 * drawn_radius(random)};
  const Vec3 normal = random.direction();
  const bool is_flat = random.uniform() < 0.5;
  for (std::size_t i = 0, count = 2 + random.below(6); i < count; ++i) {
    Vec3 offset = size * random.uniform() * random.direction();
    if (is_flat) offset -= offset.dot(normal) * normal;
    blade.points.push_back({link, place + offset});
  }
  blade.points.push_back({link, place});
  return blade;
}

/// Adds three joints that slide along z, y and x of the base, up to sign.
void add_slides(Drawn& drawn, double range) {
  drawn.judged.table.push_back({.slides = true});
  drawn.judged.table.push_back({.slides = true, .alpha_quarters = 1, .theta_quarters = 1});
  drawn.judged.table.push_back({.slides = true, .alpha_quarters = 1});
  for (int k = 0; k < 3; ++k) drawn.limits.push_back(sliding(range));
}

/// Returns a tip that carries `body`, as a robot of three prismatic joints. The step of a tip has
/// no joint limits, so the joints are longer than any attempt.
RobotUnderTest tip_with(monitor::JudgedBody body) {
  Drawn drawn;
  add_slides(drawn, 1e5);
  drawn.judged.bodies.push_back(std::move(body));
  RobotUnderTest robot = robot_of(std::move(drawn));
  robot.starts.assign(3, {-150.0, 150.0});
  return robot;
}

}  // namespace

std::span<const RobotUnderTest> robots_under_test() {
  static const std::array<RobotUnderTest, 2> robots{
      known_robot("psm", "six joints about a port: a da Vinci manipulator with an 8 mm instrument",
                  psm(), monitor::judged_psm(),
                  {{-0.6, 0.6}, {-0.5, 0.5}, {90.0, 125.0}, {-2.0, 2.0}, {-0.6, 0.6}, {-0.6, 0.6}}),
      known_robot("seven_joint_arm", "seven revolute joints and a straight shaft, without a port",
                  seven_joint_arm(), monitor::judged_seven_joint_arm(),
                  {{-1, 1}, {0.2, 0.9}, {-1, 1}, {-1.6, -0.8}, {-1, 1}, {0.3, 1.2}, {-1, 1}})};
  return robots;
}

const RobotUnderTest& robot_named(const std::string& name) {
  const auto robots = robots_under_test();
  const auto found = std::ranges::find(robots, name, &RobotUnderTest::name);
  if (found == robots.end()) throw Error("there is no robot '" + name + "'");
  return *found;
}

bool RobotUnderTest::has_port() const noexcept {
  const std::vector<LinkPoint>& shaft = bodies.front().points;
  return shaft.size() == 2 && shaft.front().link == 0 && shaft.back().link > 0;
}

RobotUnderTest chosen_robot(const std::string& robot, const std::filesystem::path& bodies) {
  if (is_robot_file(robot)) return robot_of_files(robot, bodies);
  if (bodies.empty()) return robot_named(robot);
  throw Error("--bodies: the robot '" + robot +
              "' has its own bodies: name a URDF file as --robot");
}

RobotUnderTest drawn_robot(Random& random) {
  Drawn drawn;
  const std::size_t joints = 3 + random.below(5);
  const bool has_right_angles = random.uniform() < 0.5;
  for (std::size_t k = 0; k < joints; ++k) {
    const bool slides = random.uniform() < 0.25;
    drawn.judged.table.push_back(
        {.slides = slides,
         .a = random.uniform() < 0.5 ? 0.0 : random.uniform(0.0, 60.0),
         .alpha_quarters =
             has_right_angles ? std::floor(random.uniform(-1.0, 2.0)) : random.uniform(-2.0, 2.0),
         .d = random.uniform(0.0, 60.0),
         .theta_quarters = has_right_angles ? 0.0 : random.uniform(-2.0, 2.0)});
    drawn.limits.push_back(slides ? sliding(random.uniform(5.0, 60.0))
                                  : turning(random.uniform(0.5, 3.0)));
  }
  const int last = static_cast<int>(joints);
  const std::size_t bodies = 1 + random.below(3);
  for (std::size_t b = 0; b < bodies; ++b) {
    // The last body is on the last link, and is the tool.
    const int link = b + 1 == bodies ? last : 1 + static_cast<int>(random.below(joints));
    const Vec3 place = random.uniform(0.0, 15.0) * random.direction();
    const double kind = random.uniform();
    if (kind < 0.25) {
      drawn.judged.bodies.push_back({{{link, place}}, drawn_radius(random)});
    } else if (kind < 0.6) {
      const int from = random.uniform() < 0.5 ? link : link - 1;
      const Vec3 other = random.uniform(0.0, 15.0) * random.direction();
      drawn.judged.bodies.push_back({{{from, other}, {link, place}}, drawn_radius(random)});
    } else {
      drawn.judged.bodies.push_back(blade_at(link, place, random.uniform(1.0, 12.0), random));
    }
  }
  return robot_of(std::move(drawn));
}

RobotUnderTest sliding_ball(Random& random) {
  return tip_with({{{3, Vec3::Zero()}}, drawn_radius(random)});
}

RobotUnderTest sliding_hull(Random& random) {
  return tip_with(blade_at(3, Vec3::Zero(), random.uniform(0.5, 15.0), random));
}

RobotUnderTest robot_with_stuck_bodies(Random& random) {
  Drawn drawn;
  drawn.judged.table.push_back({.slides = true});
  drawn.limits.push_back({.lower = -100.0, .upper = 0.0, .velocity = sliding_velocity});
  add_slides(drawn, 500.0);
  const auto beside = [&](int link) {
    const Vec3 place = random.uniform(8.0, 16.0) * random.direction();
    return random.uniform() < 0.5 ? monitor::JudgedBody{{{link, place}}, random.uniform(0.1, 2.0)}
                                  : blade_at(link, place, 4.0, random);
  };
  drawn.judged.bodies.push_back(beside(0));
  drawn.judged.bodies.push_back(beside(1));
  drawn.judged.bodies.push_back(random.uniform() < 0.5
                                    ? monitor::JudgedBody{{{4, Vec3::Zero()}}, drawn_radius(random)}
                                    : blade_at(4, Vec3::Zero(), 6.0, random));
  RobotUnderTest robot = robot_of(std::move(drawn));
  robot.starts = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
  return robot;
}

RobotUnderTest with_blade(RobotUnderTest robot, Random& random) {
  const monitor::JudgedPoint tip = robot.model.bodies.back().points.back();
  robot.model.bodies.push_back(blade_at(tip.link, tip.position, random.uniform(2.0, 12.0), random));
  robot.bodies.push_back(body_of(robot.model.bodies.back()));
  return robot;
}

RobotUnderTest without_velocity_limits(RobotUnderTest robot) {
  robot.joints = all_joints(robot.make({}).chain());
  for (Joint& joint : robot.joints) {
    joint.limits.velocity = std::numeric_limits<double>::infinity();
  }
  return robot;
}

}  // namespace keepout::app
