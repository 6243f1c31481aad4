// SPDX-License-Identifier: BSD-3-Clause
// A teleoperation loop at 1 kHz with the names of CRTK, and a simulated operator and robot. Two
// structs replace the topics of a dVRK. docs/controllers.md describes the connections.
#include <algorithm>
#include <cstdio>

#include "keepout/control/crtk_session.h"
#include "keepout/index/query.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/keepout.h"

/// Replaces a PSM: follows its setpoint with a small delay. In meters, in its own frame.
struct Robot {
  keepout::Pose pose;
  // Subscribe: /PSM1/operating_state, /PSM1/measured_cp and /PSM1/setpoint_cp.
  void report(keepout::CrtkSession& session, double now) const {
    session.on_operating_state(keepout::OperatingState::enabled, true);
    session.on_measured_cp(pose, {now});
    session.on_setpoint_cp(pose, {now});
  }
  void servo_cp(const keepout::Pose& setpoint) {  // publish: /PSM1/servo_cp
    pose.position += 0.3 * (setpoint.position - pose.position);
    pose.rotation = setpoint.rotation;
  }
};

/// Replaces an MTM and the teleoperation: moves into the anatomy, along in it, and back, in four
/// seconds. Distances are those of the robot's goal from its start. [m]
struct Hand {
  double largest_force = 0.0;
  keepout::Vec3 way(double seconds) const {
    const double down = std::min(seconds, 1.0) - std::clamp(seconds - 2.0, 0.0, 1.0);
    const double sideways = std::clamp(seconds - 1.0, 0.0, 1.0);
    return {0.010 * sideways, 0.0, -0.010 * down};
  }
  void servo_cf(const keepout::Wrench& wrench) {  // publish: /MTMR/body/servo_cf
    largest_force = std::max(largest_force, wrench.force.norm());
  }
};

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\n", argv[0]);
    return 2;
  }
  const auto mesh = keepout::load_mesh(argv[1]).mesh;
  constexpr double margin = 0.5, tool_radius = 0.5;  // [mm]

  // The pose of the mesh in the robot's frame. In an application it is the result of a
  // registration. Here the robot's origin is 150 mm above the middle of the mesh, and both have the
  // same axes.
  const keepout::Vec3 middle = mesh->bounds().center();
  Eigen::Matrix4d mesh_from_robot = Eigen::Matrix4d::Identity();
  mesh_from_robot.topRightCorner<3, 1>() = middle + keepout::Vec3(0, 0, 150);
  const auto registration = keepout::Registration::mesh_from_robot(
      mesh_from_robot, {.transform = keepout::LengthUnit::millimetre,
                        .robot = keepout::LengthUnit::metre,
                        .mesh = keepout::LengthUnit::millimetre});

  keepout::CrtkSession session(
      keepout::make_motion_constraint(mesh,
                                      {.options = {.tool_radius = tool_radius, .margin = margin}}),
      registration,
      {.haptic = {.period = 0.001,
                  .spring = {.stiffness = 1.0, .damping = 0.002, .largest_force = 4.0},
                  .largest_brake = 0.01},
       .motion_scale = 0.5});

  // The robot starts 5 mm above the highest vertex, so that the operator pushes the tool into the
  // mesh.
  const keepout::Vec3 highest = *std::ranges::max_element(
      mesh->vertices(), {}, [](const keepout::Vec3& vertex) { return vertex.z(); });
  const keepout::Vec3 start = highest + keepout::Vec3(0, 0, 5);
  Robot robot{{registration.point_to_robot(start), keepout::Mat3::Identity()}};
  Hand hand;
  const keepout::Pose begin = robot.pose;
  robot.report(session, 0.0);
  if (!is_ok(session.engage(0.0))) {
    std::fprintf(stderr, "%s\n", session.reason().data());
    return 1;
  }

  const keepout::WideBvh index(mesh);
  keepout::NearestTriangle nearest_triangle(*mesh, index);
  double nearest = 1e9;
  int held = 0, stopped = 0;
  constexpr int cycles = 4000;
  for (int cycle = 0; cycle < cycles; ++cycle) {  // here: wait for the next millisecond
    const double now = 0.001 * (cycle + 1);
    robot.report(session, now);
    const bool message_lost = cycle % 100 < 3;
    if (!message_lost) {
      session.on_servo_cp({begin.position + hand.way(0.001 * cycle), begin.rotation}, {now});
    }
    session.tick(now);
    robot.servo_cp(*session.setpoint_cp());  // after a failed cycle, the last one
    hand.servo_cf(session.servo_cf());       // after a failed cycle, it fades out

    if (!session.cycle().ok() && stopped++ == 0) std::printf("%s\n", session.reason().data());
    held += session.cycle().step == keepout::Status::limited;
    nearest = std::min(nearest, nearest_triangle(session.cycle().proxy).closest.offset.norm());
  }

  const keepout::EnergyReport& energy = session.energy();
  std::printf("held back in %d of %d cycles, stopped in %d, nearest %.9f mm of %.1f\n", held,
              cycles, stopped, nearest, tool_radius + margin);
  std::printf("largest force on the tool %.9f N, on the hand %.9f N\n", energy.largest_force,
              hand.largest_force);
  std::printf(
      "energy [mJ]: to the hand %.12f, stored %.12f, dissipated %.12f, from the proxy %.12f, "
      "active %.12f\n",
      energy.to_hand, energy.stored, energy.dissipated, energy.from_proxy, energy.active);
  if (held > 0) return 0;
  std::fprintf(stderr,
               "The mesh never limited the tool: see what `keepout inspect` says about it.\n");
  return 1;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
