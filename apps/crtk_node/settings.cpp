// SPDX-License-Identifier: BSD-3-Clause
#include "settings.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "keepout/error.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/robots.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/progress.h"
#include "shared/robot_file.h"
#if KEEPOUT_HAS_URDF
#include "keepout/urdf/read_robot.h"
#endif

namespace keepout::crtk {
namespace {

/// Returns a namespace without slashes at its ends. Throws Error if it is no name of a topic.
std::string name_of_topic(const char* option, std::string name) {
  while (name.starts_with('/')) name.erase(0, 1);
  while (name.ends_with('/')) name.pop_back();
  const bool is_valid =
      !name.empty() && name.size() <= 200 && std::ranges::all_of(name, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '_' || c == '/';
      });
  if (!is_valid) {
    throw Error(std::string(option) + " must be a name of letters, digits, '_' and '/', not " +
                app::in_quotes(name));
  }
  return name;
}

void require(const char* option, double value, double low, double high) {
  if (value >= low && value <= high) return;  // also refuses NaN
  throw Error(std::string(option) + " must be a number from " + nlohmann::json(low).dump() +
              " to " + nlohmann::json(high).dump());
}

/// Reads the file of `keepout register --json`.
Registration read_registration(const Settings& settings) {
  const std::string file = settings.registration.string();
  std::ifstream in(settings.registration);
  if (!in) throw Error("cannot read the registration '" + file + "'");
  Eigen::Matrix4d matrix;
  nlohmann::json json;
  std::string doubt;
  try {
    json = nlohmann::json::parse(in);
    const auto& rows = json.at("mesh_from_robot");
    if (rows.size() != 4) throw Error(file + ": 'mesh_from_robot' must have four rows");
    for (int i = 0; i < 4; ++i) {
      const auto row = rows.at(i).get<std::vector<double>>();
      if (row.size() != 4) throw Error(file + ": each row of 'mesh_from_robot' needs four numbers");
      for (int k = 0; k < 4; ++k) matrix(i, k) = row[k];
    }
    if (json.at("unit") != "mm") throw Error(file + ": the 'unit' of the translation must be mm");
    doubt = json.value("doubt", std::string());
  } catch (const nlohmann::json::exception& error) {
    throw Error(
        file + " is no registration of 'keepout register --json': " + app::printable(error.what()));
  }
  if (!doubt.empty()) {
    throw Error(file + ": do not trust this registration: " + app::printable(doubt));
  }
  const auto margin = json.find("margin");
  if (margin != json.end() && margin->is_number() && !(settings.margin >= margin->get<double>())) {
    throw Error("--margin must be at least the margin of the registration in " + file + ", " +
                margin->dump() + " mm");
  }
  return Registration::mesh_from_robot(matrix, {.transform = LengthUnit::millimetre,
                                                .robot = LengthUnit::metre,
                                                .mesh = LengthUnit::millimetre});
}

Instrument instrument_of(const Settings& settings) {
  if (settings.robot == "psm") return psm();
  if (settings.robot == "seven_joint_arm") return seven_joint_arm();
  if (!app::is_robot_file(settings.robot)) {
    throw Error("--robot must be psm, seven_joint_arm or a URDF file, not " +
                app::in_quotes(settings.robot));
  }
#if KEEPOUT_HAS_URDF
  const UrdfRobot read = read_robot(settings.robot, settings.bodies);
  for (const std::string& notice : read.notices) app::warn_on_stderr(notice);
  const Pose& base = read.instrument.chain().base();
  if (base.position != Vec3::Zero() || base.rotation != Mat3::Identity()) {
    throw Error(settings.bodies.string() +
                ": remove 'base_pose': the registration states where the anatomy is");
  }
  return read.instrument;
#else
  throw Error("this build reads no URDF: it needs liburdfdom-dev and liburdfdom-headers-dev");
#endif
}

}  // namespace

void add_options(CLI::App& app, Settings& settings) {
  const std::map<std::string, Role> roles{{"guard", Role::guard}, {"robot", Role::robot}};
  app.add_option("--as", settings.role,
                 "guard: the node; robot: a simulated robot and operator, to try the node")
      ->transform(CLI::CheckedTransformer(roles))
      ->option_text("guard|robot");
  app.add_option("--mesh", settings.mesh, "The anatomy [mm]: a file, or a sample mesh")->required();
  app.add_option("--registration", settings.registration,
                 "Where the anatomy is: the file of 'keepout register --json'")
      ->required();
  app.add_option("--arm", settings.arm, "Namespace of the robot, for example PSM1")->required();
  app.add_option("--guard", settings.guard,
                 "Namespace of this node for the teleoperation; default: keepout/ARM");
  app.add_option("--frame", settings.frame,
                 "Frame of the robot's poses; others are refused; default: ARM_base");
  app.add_option("--hand", settings.hand,
                 "Namespace that gets the force on the hand (servo_cf), for example MTMR/body");
  app.add_option(
      "--robot", settings.robot,
      "Guard the whole instrument of this robot by its joints: psm, seven_joint_arm or a "
      "URDF file; default: guard the tip");
  app.add_option("--bodies", settings.bodies, "Bodies of the robot of a URDF file: a JSON file");
  app.add_option("--tool-radius", settings.tool_radius, "Radius of the tip's ball [mm]")
      ->capture_default_str();
  app.add_option("--margin", settings.margin, "Required clearance of the tool [mm]")
      ->capture_default_str();
  app.add_flag("--monitor", settings.monitor,
               "An independent monitor confirms each motion, or the tool stands still");
  app.add_option("--period", settings.period, "Period of the loop [s]")->capture_default_str();
  app.add_option("--top-speed", settings.top_speed, "Top speed of the setpoints [mm/s]")
      ->capture_default_str();
  app.add_option("--silence", settings.silence, "Messages are used for this time [s]")
      ->capture_default_str();
  app.add_option("--lag", settings.lag, "Largest distance from setpoint to robot [mm]")
      ->capture_default_str();
  app.add_option("--for", settings.seconds,
                 "End after this time and print lost cycles and memory [s]; 0: run until a signal")
      ->capture_default_str();
}

void complete(Settings& settings) {
  settings.arm = name_of_topic("--arm", settings.arm);
  settings.guard =
      name_of_topic("--guard", settings.guard.empty() ? "keepout/" + settings.arm : settings.guard);
  if (!settings.hand.empty()) settings.hand = name_of_topic("--hand", settings.hand);
  if (settings.frame.empty()) settings.frame = settings.arm + "_base";
  if (settings.guard == settings.arm) throw Error("--guard must differ from --arm");
  require("--period", settings.period, 1e-4, 1.0);
  require("--for", settings.seconds, 0.0, 1e9);
  require("--silence", settings.silence, 0.0, 10.0);
}

Scene load_scene(const Settings& settings) {
  const Registration registration = read_registration(settings);
  auto mesh = app::load_named_mesh(settings.mesh).mesh;
  auto index = make_or_load_index(mesh, {});
  return {std::move(mesh), std::move(index), registration};
}

MotionConstraint make_tip_guard(const Settings& settings, const Scene& scene) {
  return make_motion_constraint(
      scene.mesh, scene.index,
      {.options = {.tool_radius = settings.tool_radius, .margin = settings.margin},
       .monitor = settings.monitor});
}

CrtkSession make_session(const Settings& settings, const Scene& scene) {
  const CrtkOptions options{.haptic = {.period = settings.period,
                                       .top_speed = settings.top_speed,
                                       .fade = std::max(HapticOptions{}.fade, settings.period)},
                            .longest_silence = settings.silence,
                            .farthest_lag = settings.lag,
                            .frame = settings.frame};
  if (settings.robot.empty()) {
    return {make_tip_guard(settings, scene), scene.registration, options};
  }
  const Instrument instrument = instrument_of(settings);
  const double band =
      std::min(recommended_band(instrument, settings.period), 0.5 * settings.margin);
  return {make_instrument_constraint(
              scene.mesh, scene.index, instrument,
              {.monitor = settings.monitor,
               .options = {.margin = settings.margin, .band = band, .period = settings.period}}),
          scene.registration, options};
}

}  // namespace keepout::crtk
