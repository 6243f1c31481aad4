// SPDX-License-Identifier: BSD-3-Clause
// Masses and servos of a simulated robot, and keepout simulate --physics. That the kinematics of
// its model are ours: KinematicsPeers.

#include "simulate/simulated_robot.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "apps/command_process.h"
#include "keepout/error.h"
#include "keepout/fixtures/random.h"
#include "keepout/fixtures/robots.h"
#include "keepout/module.h"
#include "shared/columns.h"

namespace keepout::app {
namespace {

using Positions = std::vector<double>;

// The values of fixtures/robots/psm_dynamics.xml, in N m, or N for the insertion.
constexpr std::array limits{8.0, 8.0, 40.0, 0.4, 0.12, 0.12};
constexpr std::array stiffness{8500.0, 7000.0, 60000.0, 13.0, 1.3, 1.3};  // per rad or m
constexpr std::array damping{48.0, 39.0, 330.0, 0.072, 0.0073, 0.0073};   // per rad/s or m/s

/// Returns the SI unit of a joint's position, in the unit of the chain.
double unit(std::size_t joint) { return joint == 2 ? 1e-3 : 1.0; }

class SimulatedPsm : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_module("mujoco")) GTEST_SKIP() << "libmujoco-dev was not there";
  }
  const Positions home_{0.3, -0.4, 110.0, 0.5, -0.2, 0.4};
};

TEST_F(SimulatedPsm, NoServoExceedsItsEffortAndAJumpNeedsAllOfIt) {
  const auto robot = make_simulated_robot("psm");
  ASSERT_TRUE(std::ranges::equal(robot->effort_limits(), limits));
  Random random(1);
  robot->start(home_);
  std::array<double, 6> largest{};
  for (int jump = 0; jump < 40; ++jump) {
    Positions setpoint = home_;
    for (std::size_t k = 0; k < 6; ++k) {
      setpoint[k] += random.uniform(-0.2, 0.2) * (k == 2 ? 100.0 : 1.0);
    }
    for (int cycle = 0; cycle < 100; ++cycle) {
      robot->follow(setpoint);
      for (std::size_t k = 0; k < 6; ++k) {
        largest[k] = std::max(largest[k], std::abs(robot->efforts()[k]));
      }
    }
  }
  for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(largest[k], limits[k]) << "joint " << k + 1;
}

TEST_F(SimulatedPsm, WithoutGravityItComesToRestAtItsSetpoint) {
  const auto robot = make_simulated_robot("psm", 0.0);
  robot->start(home_);
  const Positions other{-0.3, 0.2, 130.0, 0.0, 0.3, -0.4};
  for (int cycle = 1; cycle <= 1500; ++cycle) {
    const double part = std::min(1.0, cycle / 1000.0);
    Positions setpoint = home_;
    for (std::size_t k = 0; k < 6; ++k) setpoint[k] += part * (other[k] - home_[k]);
    robot->follow(setpoint);
  }
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(robot->positions()[k], other[k], 1e-9) << "rounding alone, joint " << k + 1;
    EXPECT_NEAR(robot->efforts()[k], 0.0, 1e-9);
  }
}

TEST_F(SimulatedPsm, UnderGravityTheServosCarryTheWeightsAndGiveWayByTheirStiffness) {
  // The masses [kg] and their centers in the frames of the links [mm].
  struct Mass {
    double kg;
    Vec3 center;
  };
  const std::array<Mass, 6> masses{{{4.0, {0, 0, -250}},
                                    {3.0, {0, -45, 0}},
                                    {0.4, {0, 0, 0}},
                                    {0.04, {0, 0, -200}},
                                    {0.004, {4.5, 0, 0}},
                                    {0.003, {0, 5, 0}}}};
  const auto robot = make_simulated_robot("psm");
  robot->start(home_);
  const Instrument instrument = psm();
  ChainState state;
  instrument.chain().forward_kinematics(robot->positions(), state);
  double largest = 0.0;
  for (int k = 1; k <= 6; ++k) {
    double load = 0.0;  // the gradient of the potential energy
    for (int link = k; link <= 6; ++link) {
      const auto& [kg, center] = masses[static_cast<std::size_t>(link - 1)];
      const Pose at = state.link(link);
      const Vec3 place = at.position + at.rotation * center;
      load += standard_gravity * kg * state.linear(k, link, place).z() * (k == 3 ? 1.0 : 1e-3);
    }
    const auto joint = static_cast<std::size_t>(k - 1);
    EXPECT_NEAR(robot->efforts()[joint], load, 1e-8) << "joint " << k;
    const double given = (home_[joint] - robot->positions()[joint]) * unit(joint);
    EXPECT_NEAR(given, load / stiffness[joint], 1e-12) << "joint " << k;
    largest = std::max(largest, std::abs(load));
  }
  EXPECT_GT(largest, 3.0) << "nothing balances the carriage along the shaft";
}

TEST_F(SimulatedPsm, AJointThatTurnsSteadilyLagsByDampingOverStiffness) {
  const auto robot = make_simulated_robot("psm", 0.0);
  for (std::size_t k = 0; k < 6; ++k) {
    Positions setpoint(6, 0.0);
    setpoint[2] = 100.0;
    robot->start(setpoint);
    const double velocity = k == 2 ? 50.0 : 0.3;  // [mm/s or rad/s]
    for (int cycle = 0; cycle < 400; ++cycle) {
      setpoint[k] += 1e-3 * velocity;
      robot->follow(setpoint);
    }
    const double lag = (setpoint[k] - robot->positions()[k]) / velocity;  // [s]
    // A setpoint is held for a cycle, and so is up to a cycle late.
    EXPECT_GT(lag, damping[k] / stiffness[k] - 1e-3) << "joint " << k + 1;
    EXPECT_LT(lag, damping[k] / stiffness[k] + 1e-4) << "joint " << k + 1;
  }
}

TEST_F(SimulatedPsm, TheSameSetpointsGiveTheSameBits) {
  const auto walk = [this](SimulatedRobot& robot) {
    Random random(3);
    Positions setpoint = home_, all;
    robot.start(setpoint);
    for (int cycle = 0; cycle < 500; ++cycle) {
      for (std::size_t k = 0; k < 6; ++k) setpoint[k] += random.uniform(-1e-3, 1e-3);
      robot.follow(setpoint);
      all.insert(all.end(), robot.positions().begin(), robot.positions().end());
    }
    return all;
  };
  const auto one = make_simulated_robot("psm"), other = make_simulated_robot("psm");
  const Positions first = walk(*one);
  EXPECT_EQ(first, walk(*other));
  EXPECT_EQ(first, walk(*one)) << "start() forgets the stroke before";
}

TEST(SimulatedRobot, AnotherRobotIsRefused) {
  try {
    make_simulated_robot("seven_joint_arm");
    ADD_FAILURE() << "it has no model";
  } catch (const Error& error) {
    EXPECT_CONTAINS(std::string(error.what()), "'seven_joint_arm': leave out --physics");
  }
}

Json record_with_physics(const test::CommandFolder& folder, const std::string& arguments) {
  test::succeeded(
      folder.run("simulate gear --robot psm --physics --strokes 3 --json r.json "
                 "--out r.html " +
                 arguments));
  std::ifstream file(folder.file("r.json"));
  return Json::parse(file);
}

TEST_F(SimulatedPsm, TheSetpointKeepsItsClearanceAndTheMeasuredInstrumentIsApart) {
  const test::CommandFolder folder;
  const Json record = record_with_physics(folder, "--speed 0.2 --margin 0.5");
  const Json& rows = record["rows"];
  ASSERT_EQ(rows.size(), 2u);
  const Json &setpoint = rows[0], &measured = rows[1];
  EXPECT_EQ(setpoint["mode"], "setpoint");
  EXPECT_EQ(measured["mode"], "measured");
  EXPECT_EQ(record["certified_mm"], 0.498);
  double nearest = 1.0;
  for (const Json& row : rows) {
    EXPECT_EQ(row["cycles"], 3u * 2000u) << "once in and back at 100 mm/s";
    EXPECT_EQ(row["mm_per_s"], 100.0);
    EXPECT_EQ(row["margin_mm"], 0.5);
  }
  EXPECT_EQ(setpoint["below"], 0u);
  for (const char* body : {"shaft", "wrist", "jaw"}) {
    const std::string name = body;
    const Json& least = setpoint[name + "_least_mm"];
    if (!least.is_null()) nearest = std::min(nearest, least.get<double>());
    EXPECT_TRUE(setpoint[name + "_error_mm"].is_null());
    const double error = measured[name + "_error_mm"];
    EXPECT_GT(error, 0.01) << name;  // gravity alone: 4 N / 60 N/mm
    EXPECT_LT(error, 5.0) << name;
    EXPECT_EQ(measured[name + "_asks_mm"], error + 0.002);
    // The bodies are rigid, so an error takes at most its length from a clearance.
    const Json& left = measured[name + "_least_mm"];
    EXPECT_TRUE(left.is_null() || left >= 0.498 - error - 1e-6) << name;
  }
  EXPECT_LT(nearest, 0.51) << "no stroke reached the surface";
  const Json& runs = record["meshes"][0]["strokes"][0]["runs"];
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_NE(runs[0]["places"], runs[1]["places"]);
}

TEST_F(SimulatedPsm, ASeedGivesTheSameRecord) {
  const test::CommandFolder folder;
  const auto record = [&](const std::string& seed) {
    Json json = record_with_physics(folder, "--speed 0.2 --cycles 500 --seed " + seed);
    for (const char* of_the_run : {"date", "command", "machine", "settings"}) {
      json.erase(of_the_run);
    }
    return json.dump();
  };
  const std::string one = record("1");
  EXPECT_EQ(one, record("1"));
  EXPECT_NE(one, record("2"));
}

TEST(SimulateRobot, PhysicsNeedsARobotAndMujoco) {
  const test::CommandFolder folder;
  folder.expect_refused("simulate cube --physics", "--robot");
  const test::ProcessOutcome outcome =
      folder.run("simulate cube --robot psm --physics", "KEEPOUT_MODULES=nowhere");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_CONTAINS(outcome.output, "--physics needs MuJoCo: install libmujoco-dev");
}

}  // namespace
}  // namespace keepout::app
