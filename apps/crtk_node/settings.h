// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "keepout/control/crtk_session.h"

namespace CLI {
class App;
}

namespace keepout::crtk {

/// The role of a process.
enum class Role : std::uint8_t {
  guard,  // between a teleoperation and a robot
  robot   // a simulated robot and its operator, to try the guard
};

/// The options of a node. Lengths are in mm.
struct Settings {
  Role role = Role::guard;
  std::string mesh = {};                    // a file or a sample mesh
  std::filesystem::path registration = {};  // what `keepout register --json` writes
  std::string arm = {};                     // the namespace of the robot
  std::string guard = {};                   // the namespace of the guard; empty: keepout/<arm>
  std::string frame = {};                   // of the robot's poses; empty: <arm>_base
  std::string hand = {};                    // the namespace that gets servo_cf; empty: no force
  std::string robot = {};                   // the instrument; empty: a tip
  std::filesystem::path bodies = {};        // of the robot of a URDF file
  double tool_radius = 0.0;                 // of a tip [mm]
  double margin = 0.5;                      // [mm]
  bool monitor = false;                     // confirms each motion, or the tool stands still
  double period = 0.001;                    // [s]
  double top_speed = 200.0;                 // of the tip or the flange [mm/s]
  double silence = 0.02;                    // messages are used for this time [s]
  double lag = 5.0;                         // from setpoint to robot [mm]
  double seconds = 0.0;                     // after which the process ends; 0: never

  /// Returns the name of a topic of the robot.
  std::string of_robot(const std::string& command) const { return "/" + arm + "/" + command; }
  /// Returns the name of a topic of the guard.
  std::string of_guard(const std::string& command) const { return "/" + guard + "/" + command; }
};

/// Adds the options to a command line.
void add_options(CLI::App& app, Settings& settings);

/// Sets the members that depend on others. Throws Error for an option that is out of range.
void complete(Settings& settings);

/// The anatomy, and where it is.
struct Scene {
  std::shared_ptr<const Mesh> mesh;           // [mm]
  std::shared_ptr<const SpatialIndex> index;  // of the mesh
  Registration registration;                  // the robot's unit is the meter
};

/// Reads mesh and registration. Throws Error, which names the file, if one of them cannot be used,
/// and if the margin is smaller than the one that the registration needs.
Scene load_scene(const Settings& settings);

/// Makes the motion constraint of a tip. Throws Error.
MotionConstraint make_tip_guard(const Settings& settings, const Scene& scene);

/// Makes the session of a tip, or of the instrument that the settings name. Throws Error.
CrtkSession make_session(const Settings& settings, const Scene& scene);

}  // namespace keepout::crtk
