// SPDX-License-Identifier: BSD-3-Clause
// The node with a transport that sends it anything.
#include "guard_node.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "temporary_folder.h"
#include "trials.h"

namespace keepout::crtk {
namespace {

constexpr double clearance = 3.0;     // tool radius and margin [mm]
constexpr double longest = 0.2;       // of a cycle at the top speed [mm]
constexpr double side = 20.0;         // half the side of the cube [mm]
constexpr double tolerance = 1e-9;    // of transforms to meters and back [mm]
const Vec3 translation(11, -7, 150);  // from the robot's origin to that of the mesh [mm]

/// Keeps what was sent last, and what the next delivery will be.
class ScriptedTransport final : public Transport {
 public:
  int subscribe(const std::string& topic, Kind) override {
    const int number = static_cast<int>(subscribed.size());
    return subscribed[topic] = number;
  }
  int advertise(const std::string& topic, Kind, bool) override {
    announced.push_back(topic);
    return static_cast<int>(announced.size()) - 1;
  }
  void deliver(Inbox& inbox, double) override {
    for (const auto& [topic, message] : queue) inbox.receive(topic, message);
    queue.clear();
  }
  bool send(int topic, const Message& message) override {
    const std::string& name = announced[static_cast<std::size_t>(topic)];
    if (name == "/PSM1/servo_cp") setpoint = message;
    if (name == "/PSM1/servo_jp") {
      joints.assign(message.positions.data, message.positions.data + message.positions.size);
    }
    return true;
  }
  int publishers(int) override { return others; }
  bool is_read(int) override { return false; }

  std::map<std::string, int> subscribed;
  std::vector<std::string> announced;
  std::vector<std::pair<int, Message>> queue;
  std::optional<Message> setpoint;  // of a cycle
  std::vector<double> joints;       // of a cycle
  int others = 0;                   // publishers of each topic
};

/// Draws numbers of all kinds.
class Hostile {
 public:
  double number() {
    constexpr std::array all{std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity(),
                             1e308,
                             -1e308,
                             0.0,
                             -0.0,
                             5e-324,
                             1.0,
                             -0.5};
    return all[below(all.size())];
  }
  std::size_t below(std::size_t count) { return random_() % count; }
  double within(double low, double high) {
    return std::uniform_real_distribution(low, high)(random_);
  }

  /// Returns a message for any topic. Views are valid until the next call.
  Message message(double now) {
    Message message;
    constexpr std::array<std::string_view, 4> texts{"ENABLED", "PSM1_base", "", "\xff\xfe"};
    long_text_.assign(below(3000), 'x');
    numbers_.resize(below(70));
    for (double& one : numbers_) one = below(2) == 0 ? number() : within(-1, 1);
    message.stamp = below(4) == 0 ? number() : now - within(-0.01, 0.05);
    message.frame = below(5) == 0 ? std::string_view(long_text_) : texts[below(4)];
    for (double& one : message.vector) one = number();
    for (double& one : message.rotation) one = below(2) == 0 ? number() : within(-1, 1);
    message.positions = message.velocities = {numbers_.data(), numbers_.size()};
    message.text = below(5) == 0 ? std::string_view(long_text_) : texts[below(4)];
    message.flag = below(2) == 0;
    return message;
  }

 private:
  std::mt19937_64 random_{40};
  std::string long_text_;
  std::vector<double> numbers_;
};

/// The node beside a cube around the origin of the mesh.
class HostileNode : public testing::Test {
 protected:
  Settings settings(const std::string& robot) {
    const auto cube = folder_.write("cube.obj",
                                    "v -20 -20 -20\nv 20 -20 -20\nv -20 20 -20\nv 20 20 -20\n"
                                    "v -20 -20 20\nv 20 -20 20\nv -20 20 20\nv 20 20 20\n"
                                    "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\n"
                                    "f 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n");
    Settings settings{.mesh = cube.string(),
                      .registration = folder_.write(
                          "registration.json",
                          "{\"unit\":\"mm\",\"mesh_from_robot\":[[1,0,0,11],[0,1,0,-7],[0,0,1,150],"
                          "[0,0,0,1]]}"),
                      .arm = "PSM1",
                      .robot = robot,
                      .tool_radius = robot.empty() ? 1.0 : 0.0,
                      .margin = 2.0,
                      .monitor = !robot.empty()};
    complete(settings);
    return settings;
  }

  TemporaryFolder folder_;
  Hostile random_;
  ScriptedTransport transport_;
};

Message pose_at(const Vec3& point, double now) {
  const Vec3 at = (point - translation) / 1000.0;
  return {.stamp = now,
          .frame = "PSM1_base",
          .vector = {at.x(), at.y(), at.z()},
          .rotation = {0.6, 0.0, 0.0, 0.8}};
}

TEST_F(HostileNode, KeepsItsClearanceAndItsSpeedWhateverArrives) {
  const Settings options = settings("");
  GuardNode node(options, load_scene(options), transport_);
  const auto number_of = [&](const std::string& topic) { return transport_.subscribed.at(topic); };
  const int engage = number_of("/keepout/PSM1/engage");
  const Vec3 home(3, 4, 30);
  Vec3 robot = home;
  Vec3 last = home;  // the setpoint of the cycle before
  bool was_engaged = false;
  int hostile = 0, sent = 0, limited = 0;
  for (double now = 1e9; hostile < test::trials(1'000'000); now += 0.001) {
    // Most messages are good, so that the session is engaged and moves.
    auto& queue = transport_.queue;
    queue.emplace_back(number_of("/PSM1/measured_cp"), pose_at(robot, now));
    queue.emplace_back(number_of("/PSM1/setpoint_cp"), pose_at(robot, now));
    queue.emplace_back(number_of("/PSM1/operating_state"),
                       Message{.stamp = now, .text = "ENABLED", .flag = true});
    const Vec3 goal = home + Vec3(20 * std::sin(now), 15 * std::cos(2 * now), -12);
    queue.emplace_back(number_of("/keepout/PSM1/servo_cp"), pose_at(goal, now));
    Message flag;
    flag.flag = random_.below(100) != 0;
    if (random_.below(20) == 0) queue.emplace_back(engage, flag);
    if (random_.below(3) == 0) {  // views of a message live until the next one
      for (int k = 0; k < 3; ++k) {
        node.receive(static_cast<int>(random_.below(transport_.subscribed.size())),
                     random_.message(now));
        ++hostile;
      }
    }
    transport_.others = random_.below(200) == 0 ? 2 : 0;

    transport_.setpoint.reset();
    node.cycle(now);
    if (!transport_.setpoint) {
      was_engaged = false;
      if (random_.below(50) == 0) robot = home;
      continue;
    }
    ++sent;
    const auto& at = transport_.setpoint->vector;
    const Vec3 point = 1000.0 * Vec3(at[0], at[1], at[2]) + translation;
    ASSERT_TRUE(point.allFinite());
    ASSERT_GE(distance_to(Box{Vec3::Constant(-side), Vec3::Constant(side)}, point),
              clearance - tolerance);
    ASSERT_LE(was_engaged ? (point - last).norm() : 0.0, longest + tolerance);
    limited += (point - goal).norm() > longest;
    const auto& q = transport_.setpoint->rotation;
    ASSERT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1.0, 1e-12);
    last = robot = point;
    was_engaged = true;
  }
  EXPECT_GT(sent, hostile / 10);
  EXPECT_GT(limited, sent / 10);
}

TEST_F(HostileNode, OfAnInstrumentSendsOnlyJointsWithinTheirLimits) {
  const Settings options = settings("psm");
  GuardNode node(options, load_scene(options), transport_);
  const auto number_of = [&](const std::string& topic) { return transport_.subscribed.at(topic); };
  std::vector<double> q{0.1, -0.2, 0.1, 0.3, 0.2, -0.1};  // insertion in meters
  const std::vector<double> velocity{0.2, 0.1, 0.05, 0.5, 0.5, 0.5};
  int sent = 0;
  const int most = test::trials(100'000);
  for (int cycle = 0; cycle < most; ++cycle) {
    const double now = 1e9 + 0.001 * cycle;
    auto& queue = transport_.queue;
    const Message joints{.stamp = now, .positions = {q.data(), q.size()}};
    queue.emplace_back(number_of("/PSM1/measured_js"), joints);
    queue.emplace_back(number_of("/PSM1/setpoint_js"), joints);
    queue.emplace_back(number_of("/PSM1/operating_state"),
                       Message{.stamp = now, .text = "ENABLED", .flag = true});
    queue.emplace_back(number_of("/keepout/PSM1/servo_jv"),
                       Message{.stamp = now, .velocities = {velocity.data(), velocity.size()}});
    Message flag;
    flag.flag = random_.below(1000) != 0;
    if (random_.below(20) == 0) queue.emplace_back(number_of("/keepout/PSM1/engage"), flag);
    if (random_.below(3) == 0) {
      node.receive(static_cast<int>(random_.below(transport_.subscribed.size())),
                   random_.message(now));
    }
    transport_.joints.clear();
    node.cycle(now);
    if (transport_.joints.empty()) continue;
    ++sent;
    ASSERT_EQ(transport_.joints.size(), q.size());
    ASSERT_LE(std::abs(transport_.joints[0]), 1.588 + 1e-12);
    ASSERT_LE(std::abs(transport_.joints[1]), 0.925025 + 1e-12);
    ASSERT_LE(std::abs(transport_.joints[2] - 0.12), 0.12 + 1e-12);
    q = transport_.joints;
  }
  EXPECT_GT(sent, most / 10);
}

// Found by fuzzing: a doubt that is no text ended the program with an exception of the JSON
// library.
TEST(Registration, WithAMemberOfAnotherTypeIsAnError) {
  const TemporaryFolder folder;
  for (const char* member : {"\"doubt\":5", "\"doubt\":null", "\"unit\":5"}) {
    const auto file = folder.write(
        "registration.json", R"({"mesh_from_robot":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]],)"
                             R"("unit":"mm",)" +
                                 std::string(member) + "}");
    EXPECT_CONTAINS(error_of([&] { load_scene({.mesh = "cube", .registration = file}); }),
                    file.string())
        << member;
  }
}

}  // namespace
}  // namespace keepout::crtk
