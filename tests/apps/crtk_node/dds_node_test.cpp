// SPDX-License-Identifier: BSD-3-Clause
// The node over DDS, with Fast DDS as the robot and the teleoperation.
#include <gtest/gtest.h>
#include <time.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <thread>

#include "fast_dds_peer.h"
#include "keepout/control/registration.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/robots.h"
#include "keepout/mesh/load_mesh.h"
#include "node_process.h"
#include "temporary_folder.h"

namespace keepout::test {
namespace {

constexpr double period = 0.001;     // [s]
constexpr double top_speed = 200.0;  // [mm/s]
constexpr double tool_radius = 1.0;  // [mm]
constexpr double margin = 2.0;       // [mm]
constexpr double patience = 5.0;     // of the test, for what takes milliseconds [s]
const char* const frame = "PSM1_base";

double now() {
  timespec time{};
  clock_gettime(CLOCK_REALTIME, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

WireHeader header_at(double stamp, std::string of = frame) {
  const double whole = std::floor(stamp);
  return {static_cast<std::int32_t>(whole), static_cast<std::uint32_t>(1e9 * (stamp - whole)),
          std::move(of)};
}

/// Returns a domain that other tests, which run at the same time, do not use. The ports of domains
/// above 101 are among those that the system gives to any process.
std::uint32_t own_domain() {
  static const std::uint32_t domain = 20 + static_cast<std::uint32_t>(::getpid()) % 80;
  return domain;
}

/// A cube with sides of 40 mm, in the frame of the mesh.
std::string cube_at(const Vec3& middle) {
  std::string text;
  for (int corner = 0; corner < 8; ++corner) {
    char line[120];
    std::snprintf(
        line, sizeof line, "v %.17g %.17g %.17g\n", middle.x() + (corner & 1 ? 20.0 : -20.0),
        middle.y() + (corner & 2 ? 20.0 : -20.0), middle.z() + (corner & 4 ? 20.0 : -20.0));
    text += line;
  }
  // Counterclockwise, seen from outside.
  return text +
         "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\n"
         "f 1 7 3\nf 2 4 8\nf 2 8 6\n";
}

/// Anatomy, its registration and a node; the test is the robot and the teleoperation.
class DdsNode : public testing::Test {
 protected:
  DdsNode() : matrix_(Eigen::Matrix4d::Identity()), registration_(registered()) {}
  ~DdsNode() override { peer_.reset(); }  // its threads write into the members

  Registration registered() {
    const double angle = 0.5;
    matrix_(0, 0) = matrix_(1, 1) = std::cos(angle);
    matrix_(1, 0) = std::sin(angle);
    matrix_(0, 1) = -std::sin(angle);
    matrix_.topRightCorner<3, 1>() = Vec3(11, -7, 150);
    return Registration::mesh_from_robot(matrix_, {.transform = LengthUnit::millimetre,
                                                   .robot = LengthUnit::metre,
                                                   .mesh = LengthUnit::millimetre});
  }

  void write_files(const Vec3& middle, const std::string& more = {}) {
    folder_.write("cube.obj", cube_at(middle));
    std::string json = "{\"unit\":\"mm\",\"mesh_from_robot\":[";
    for (int i = 0; i < 4; ++i) {
      char line[200];
      std::snprintf(line, sizeof line, "%s[%.17g,%.17g,%.17g,%.17g]", i == 0 ? "" : ",",
                    matrix_(i, 0), matrix_(i, 1), matrix_(i, 2), matrix_(i, 3));
      json += line;
    }
    folder_.write("registration.json", json + "]" + more + "}");
  }

  std::vector<std::string> arguments(std::vector<std::string> more = {}) const {
    std::vector<std::string> all{
        KEEPOUT_DDS_NODE,
        "--arm=PSM1",
        "--mesh=" + (folder_.path() / "cube.obj").string(),
        "--registration=" + (folder_.path() / "registration.json").string(),
        "--tool-radius=1",
        "--margin=2",
        "--silence=0.25"};  // the test is no real-time process
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  void start(const std::vector<std::string>& more = {}) {
    ::setenv("ROS_DOMAIN_ID", std::to_string(own_domain()).c_str(), 1);
    ::unsetenv("CYCLONEDDS_URI");
    node_.emplace(arguments(more), folder_.path() / "output.txt");
    start_peer();
  }

  void start_peer() {
    peer_.emplace(own_domain());
    peer_->read<WirePose>("rt/PSM1/servo_cp", [this](const WirePose& pose) {
      const std::lock_guard lock(mutex_);
      if (poses_.empty() || poses_.back().position != pose.position) poses_.push_back(pose);
      ++received_;
    });
    peer_->read<WireJoints>("rt/PSM1/servo_jp", [this](const WireJoints& joints) {
      const std::lock_guard lock(mutex_);
      if (joints_.empty() || joints_.back() != joints.position) joints_.push_back(joints.position);
      joint_names_ = joints.name;
      ++received_;
    });
    peer_->read<WirePose>("rt/keepout/PSM1/measured_cp", [this](const WirePose& pose) {
      const std::lock_guard lock(mutex_);
      seen_ = pose.position;
    });
    peer_->read<WireText>(
        "rt/keepout/PSM1/reason",
        [this](const WireText& text) {
          const std::lock_guard lock(mutex_);
          reason_ = text.data;
        },
        true);
    peer_->read<WireState>(
        "rt/keepout/PSM1/operating_state",
        [this](const WireState& state) {
          const std::lock_guard lock(mutex_);
          state_ = state.state;
        },
        true);
    state_out_ = peer_->writer<WireState>("rt/PSM1/operating_state", true);
    measured_cp_ = peer_->writer<WirePose>("rt/PSM1/measured_cp");
    setpoint_cp_ = peer_->writer<WirePose>("rt/PSM1/setpoint_cp");
    measured_js_ = peer_->writer<WireJoints>("rt/PSM1/measured_js");
    setpoint_js_ = peer_->writer<WireJoints>("rt/PSM1/setpoint_js");
    servo_cp_ = peer_->writer<WirePose>("rt/keepout/PSM1/servo_cp");
    servo_jp_ = peer_->writer<WireJoints>("rt/keepout/PSM1/servo_jp");
    engage_ = peer_->writer<WireFlag>("rt/keepout/PSM1/engage");
  }

  /// Is robot and teleoperation, at about 1 kHz, until the condition holds. Fails after a time.
  bool play(const std::function<bool()>& condition, double longest = patience) {
    const double end = now() + longest;
    while (now() < end) {
      {
        const std::lock_guard lock(mutex_);
        if (condition()) return true;
        if (!poses_.empty()) robot_ = poses_.back();
        if (!joints_.empty()) robot_joints_.position = joints_.back();
      }
      robot_.header = robot_joints_.header = header_at(now());
      measured_cp_->write(&robot_);
      setpoint_cp_->write(&robot_);
      if (!robot_joints_.position.empty()) {
        measured_js_->write(&robot_joints_);
        setpoint_js_->write(&robot_joints_);
      }
      if (goal_) {
        WirePose goal = *goal_;
        if (goal.header.frame == "now") goal.header = header_at(now());
        servo_cp_->write(&goal);
      }
      if (joint_goal_) {
        joint_goal_->header = header_at(now());
        servo_jp_->write(&*joint_goal_);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  void set_state(const std::string& state, bool is_homed) {
    WireState message{header_at(now()), state, is_homed, false};
    state_out_->write(&message);
  }

  void ask(bool to_engage) {
    WireFlag flag{to_engage};
    engage_->write(&flag);
  }

  /// Enables the robot, and engages where it is.
  void engage() {
    set_state("ENABLED", true);
    forget();
    // The node must know where the robot is now.
    ASSERT_TRUE(play([&] {
      return state_ == "PAUSED" && (!robot_joints_.position.empty() || seen_ == robot_.position);
    })) << reason_;
    play([] { return false; }, 0.03);
    double asked = 0.0;
    ASSERT_TRUE(play([&] {
      if (state_ != "ENABLED" && now() > asked + 0.3) {
        ask(true);
        asked = now();
      }
      return state_ == "ENABLED" && received_ > 0;
    })) << reason_;
  }

  /// Forgets what came from the node.
  void forget() {
    const std::lock_guard lock(mutex_);
    poses_.clear();
    joints_.clear();
    received_ = 0;
  }

  std::size_t moves() {
    const std::lock_guard lock(mutex_);
    return poses_.size();
  }

  void release() {
    goal_.reset();
    ask(false);
    ASSERT_TRUE(play([&] { return state_ == "PAUSED"; })) << reason_;
  }

  /// A pose in the robot's frame and unit. `point`: in the frame of the mesh [mm].
  WirePose pose_at(const Vec3& point) const {
    const Vec3 at = registration_.point_to_robot(point);
    return {.header = {0, 0, "now"},
            .position = {at.x(), at.y(), at.z()},
            .orientation = {0.6, 0.0, 0.0, 0.8}};
  }

  TemporaryFolder folder_;
  Eigen::Matrix4d matrix_;
  Registration registration_;
  std::optional<NodeProcess> node_;
  std::optional<FastDdsPeer> peer_;
  eprosima::fastdds::dds::DataWriter *state_out_, *measured_cp_, *setpoint_cp_, *measured_js_,
      *setpoint_js_, *servo_cp_, *servo_jp_, *engage_;
  WirePose robot_;
  WireJoints robot_joints_;
  std::optional<WirePose> goal_;
  std::optional<WireJoints> joint_goal_;
  std::mutex mutex_;
  // With the mutex: what came from the node. Equal consecutive setpoints count once.
  std::array<double, 3> seen_ = {};  // the last measured position
  std::vector<WirePose> poses_;
  std::vector<std::vector<double>> joints_;
  std::vector<std::string> joint_names_;
  int received_ = 0;
  std::string reason_, state_;
};

TEST_F(DdsNode, SetpointsAreBitwiseThoseOfADirectConstraint) {
  write_files(Vec3::Zero());
  start();
  const auto mesh = load_mesh(folder_.path() / "cube.obj").mesh;
  auto guard =
      make_motion_constraint(mesh, {.options = {.tool_radius = tool_radius, .margin = margin}});
  // From above the cube: straight down; down and along it; away from it; over its edge.
  const std::array<std::array<Vec3, 2>, 4> pairs{{{Vec3(1, 2, 45), Vec3(1, 2, 15)},
                                                  {Vec3(-15, 3, 30), Vec3(15, 8, 12)},
                                                  {Vec3(3, 4, 24), Vec3(25, -10, 50)},
                                                  {Vec3(5, 0, 25), Vec3(40, 4, 5)}}};
  std::size_t compared = 0, held = 0;
  for (const auto& [from, to] : pairs) {
    robot_ = pose_at(from);
    engage();
    goal_ = pose_at(to);
    play([&] { return poses_.size() >= 100; }, 1.0);
    release();

    const auto at = [](const WirePose& pose) {
      return Vec3(pose.position[0], pose.position[1], pose.position[2]);
    };
    const Mat3 rotation = *to_rotation({0.6, 0.0, 0.0, 0.8});
    const Quaternion q = to_quaternion(rotation);
    const Vec3 hand = registration_.point_to_mesh(at(pose_at(to)));
    Vec3 proxy = registration_.point_to_mesh(at(pose_at(from)));
    // A slow reader loses setpoints, so those that came are a part of these.
    constexpr int most_cycles = 400;
    std::size_t next = 0;
    for (int cycle = 0; cycle < most_cycles && next < poses_.size(); ++cycle) {
      if (at(poses_[next]) == registration_.point_to_robot(proxy)) {
        ASSERT_EQ(poses_[next].orientation, (std::array{q.x, q.y, q.z, q.w}));
        ++next;
      }
      // The next cycle of the direct constraint: at the top speed.
      Vec3 desired = hand - proxy;
      const double distance = desired.norm(), radius = guard.options().radius;
      if (distance > radius) desired *= radius / distance;
      const Step step = guard.step({.tip = proxy, .desired = desired});
      ASSERT_TRUE(step.ok());
      const double fraction = std::min(1.0, top_speed * period / step.motion.norm());
      const bool arrives = distance <= radius && fraction == 1.0 && step.motion == desired;
      proxy = arrives ? hand : Vec3(proxy + fraction * step.motion);
      held += step.status == Status::limited;
    }
    EXPECT_EQ(next, poses_.size()) << "a setpoint is not one of the direct constraint";
    EXPECT_GT(next, 50U) << reason_;
    compared += next;
  }
  EXPECT_GT(compared, 250U);
  EXPECT_GT(held, 50U);
}

TEST_F(DdsNode, JointSetpointsAreBitwiseThoseOfADirectConstraint) {
  const Instrument instrument = psm();
  const std::vector<double> start_m{0.1, -0.2, 0.10, 0.3, 0.2, -0.1};
  std::vector<double> q = start_m;
  q[2] *= 1000.0;  // the insertion, in mm
  ChainState chain;
  instrument.chain().forward_kinematics(q, chain);
  const Vec3 tip = chain.flange().position;  // the cube is 10 mm farther along the shaft
  const Vec3 middle_m = (tip + 30.0 * tip.normalized()) / 1000.0;
  write_files(registration_.point_to_mesh(middle_m));
  start({"--robot=psm"});
  robot_joints_.position = start_m;
  engage();
  joint_goal_ = WireJoints{.position = start_m};
  joint_goal_->position[2] += 0.04;
  joint_goal_->position[0] += 0.05;
  play([&] { return joints_.size() >= 150; }, 2.0);

  const auto mesh = load_mesh(folder_.path() / "cube.obj").mesh;
  const double band = std::min(recommended_band(instrument, period), 0.5 * margin);
  auto guard = make_instrument_constraint(
      mesh, instrument, {.options = {.margin = margin, .band = band, .period = period}});
  guard.place(0, registration_.mesh_in_robot());
  const std::lock_guard lock(mutex_);
  std::size_t held = 0, next = 0;
  for (int cycle = 0; cycle < 1000 && next < joints_.size(); ++cycle) {
    std::vector<double> expected = q;
    expected[2] /= 1000.0;
    next += joints_[next] == expected;  // a slow reader loses setpoints
    std::vector<double> desired = joint_goal_->position;
    desired[2] *= 1000.0;
    for (std::size_t j = 0; j < q.size(); ++j) desired[j] -= q[j];
    const InstrumentStep step = guard.step(q, desired);
    ASSERT_TRUE(step.ok());
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += step.increment[j];
    held += step.limits.has(Limit::mesh);
  }
  EXPECT_EQ(next, joints_.size()) << "a setpoint is not one of the direct constraint";
  EXPECT_GT(next, 50U) << reason_;
  EXPECT_GT(held, 0U);
}

TEST_F(DdsNode, JointsInAnotherOrderAreRefused) {
  write_files(Vec3(0, 0, 1000));
  start({"--robot=psm"});
  robot_joints_.position = {0.1, -0.2, 0.10, 0.3, 0.2, -0.1};
  robot_joints_.name = {"yaw", "pitch", "insertion", "roll", "wrist_pitch", "wrist_yaw"};
  engage();
  EXPECT_EQ(joint_names_, robot_joints_.name);
  joint_goal_ = robot_joints_;
  EXPECT_TRUE(play([&] { return reason_.starts_with("guarded:"); })) << reason_;
  std::swap(joint_goal_->name[0], joint_goal_->name[1]);
  EXPECT_TRUE(play([&] { return reason_.starts_with("wrong_command:"); })) << reason_;
  joint_goal_->name.clear();  // not stated
  EXPECT_TRUE(play([&] { return reason_.starts_with("guarded:"); })) << reason_;
}

TEST_F(DdsNode, StandsStillWithAReasonForEveryWrongMessage) {
  write_files(Vec3::Zero());
  start();
  robot_ = pose_at(Vec3(0, 0, 30));
  EXPECT_TRUE(play([&] { return reason_.starts_with("not_ready"); })) << reason_;
  engage();
  const WirePose good = pose_at(Vec3(0, 0, 29.9));
  goal_ = good;
  ASSERT_TRUE(play([&] { return poses_.size() >= 2 && reason_.starts_with("guarded"); }))
      << reason_;

  const auto expect_still = [&](const std::string& status, const std::function<void()>& fault) {
    SCOPED_TRACE(status);
    const std::size_t moved = moves();
    fault();
    EXPECT_TRUE(play([&] { return reason_.starts_with(status + ":"); })) << reason_;
    play([] { return false; }, 0.03);
    EXPECT_EQ(moves(), moved);
    goal_ = good;
    joint_goal_.reset();
    EXPECT_TRUE(play([&] { return reason_.starts_with("guarded"); })) << reason_;
  };
  WirePose bad = pose_at(Vec3(0, 0, 29));
  bad.header = header_at(now() + 1000.0, "other");
  expect_still("other_frame", [&] { goal_ = bad; });
  bad = pose_at(Vec3(0, 0, 29));
  bad.orientation = {0, 0, 0, 0};
  expect_still("invalid_pose", [&] { goal_ = bad; });
  bad.orientation = {0.6, 0.0, 0.0, 0.9};
  expect_still("invalid_pose", [&] { goal_ = bad; });
  bad = pose_at(Vec3(0, 0, 29));
  bad.position[1] = std::numeric_limits<double>::quiet_NaN();
  expect_still("invalid_pose", [&] { goal_ = bad; });
  bad = pose_at(Vec3(0, 0, 29));
  bad.header = header_at(now() - 1.0);
  expect_still("stale", [&] { goal_ = bad; });
  bad.header = {};  // CRTK marks invalid data so
  expect_still("stale", [&] { goal_ = bad; });
  // Above the declared size: never delivered.
  bad.header = header_at(now(), std::string(300, 'f'));
  expect_still("stale", [&] { goal_ = bad; });
  expect_still("too_far", [&] { goal_ = pose_at(Vec3(0, 0, 129)); });
  expect_still("wrong_command", [&] { joint_goal_ = WireJoints{.position = {1, 2, 3}}; });
  // Silence.
  expect_still("stale", [&] { goal_.reset(); });

  // Another publisher of the robot's commands, and of the guard's: then nothing is sent.
  for (const char* const topic : {"rt/PSM1/servo_cp", "rt/keepout/PSM1/servo_cp"}) {
    FastDdsPeer other(own_domain());
    auto* const writer = other.writer<WirePose>(topic);
    EXPECT_TRUE(play([&] { return reason_.starts_with("contested:"); })) << topic << reason_;
    goal_ = pose_at(Vec3(0, 0, 28));
    play([] { return false; }, 0.03);  // until the last setpoints have come
    forget();
    play([] { return false; }, 0.03);
    EXPECT_EQ(moves(), 0U);
    goal_ = good;
    play([] { return false; }, 0.03);  // until the node has the former goal
    other.remove(writer);
    EXPECT_TRUE(play([&] { return reason_.starts_with("guarded"); })) << reason_;
  }

  // A robot that is not ready releases the session, which stays released.
  set_state("ENABLED", false);
  EXPECT_TRUE(play([&] { return reason_.starts_with("not_ready:"); })) << reason_;
  set_state("ENABLED", true);
  EXPECT_TRUE(play([&] { return reason_.starts_with("not_engaged:"); })) << reason_;
  ask(true);
  EXPECT_TRUE(play([&] { return state_ == "ENABLED"; })) << reason_;
  set_state("DISABLED", true);
  EXPECT_TRUE(play([&] { return state_ == "DISABLED"; })) << reason_;
  EXPECT_EQ(node_->stop(), 0);
  EXPECT_CONTAINS(folder_.contents("output.txt"), "cycles by status: guarded");
}

TEST_F(DdsNode, ContinuesThroughAFloodAndTheDeathOfItsPeer) {
  write_files(Vec3::Zero());
  start();
  robot_ = pose_at(Vec3(0, 0, 30));
  engage();
  const WirePose good = pose_at(Vec3(0, 0, 29.9));
  WirePose flood = pose_at(Vec3(0, 0, 29.9));
  for (int k = 0; k < 50'000; ++k) {
    flood.header = header_at(now(), k % 2 == 0 ? frame : "other");
    servo_cp_->write(&flood);
  }
  goal_ = good;
  EXPECT_TRUE(play([&] { return poses_.size() >= 2 && reason_.starts_with("guarded"); }))
      << reason_;
  // A new robot and teleoperation, after silence: the node stands still, and goes on.
  peer_.reset();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  reason_ = "";
  start_peer();
  goal_ = good;
  EXPECT_TRUE(play([&] { return reason_.starts_with("guarded"); })) << reason_;
  EXPECT_EQ(node_->stop(), 0);
}

TEST_F(DdsNode, EndsWithAMessageForSettingsThatItCannotUse) {
  const auto ends = [&](std::vector<std::string> more, const std::string& message) {
    NodeProcess node(arguments(std::move(more)), folder_.path() / "said.txt");
    EXPECT_NE(node.wait(), 0) << message;
    EXPECT_CONTAINS(folder_.contents("said.txt"), message);
  };
  ::setenv("ROS_DOMAIN_ID", std::to_string(own_domain()).c_str(), 1);
  write_files(Vec3::Zero());
  ends({"--no-such-option"}, "no-such-option");
  ends({"--period=nan"}, "--period must be a number from");
  ends({"--guard=PSM1"}, "--guard must differ");
  ends({"--hand=a b"}, "--hand must be a name");
  ends({"--robot=scara"}, "--robot must be psm");
#if KEEPOUT_HAS_URDF
  const std::string arm = KEEPOUT_ROBOTS "/six_joint_arm";
  ends({"--robot=" + arm + ".urdf", "--bodies=" + arm + ".json"}, "remove 'base_pose'");
#endif
  write_files(Vec3::Zero(), ",\"doubt\":\"a scale of 1000\"");
  ends({}, "do not trust this registration: a scale of 1000");
  write_files(Vec3::Zero(), ",\"margin\":2.5");
  ends({}, "--margin must be at least the margin of the registration");
  folder_.write("registration.json", "{\"unit\":\"mm\"}");
  ends({}, "is no registration");
  ::setenv("ROS_DOMAIN_ID", "1000", 1);
  ends({}, "ROS_DOMAIN_ID must be a number");
}

TEST_F(DdsNode, WaitsForARobotAndCountsItsCycles) {
  ::setenv("ROS_DOMAIN_ID", std::to_string(own_domain()).c_str(), 1);
  write_files(Vec3::Zero());
  NodeProcess node(arguments({"--for=0.2"}), folder_.path() / "said.txt");
  EXPECT_EQ(node.wait(), 0);
  EXPECT_CONTAINS(folder_.contents("said.txt"), " of them by this program");
  EXPECT_CONTAINS(folder_.contents("said.txt"), "cycles by status: not_ready");
}

}  // namespace
}  // namespace keepout::test
