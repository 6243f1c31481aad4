// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "arrays.h"
#include "bindings.h"
#include "guard.h"
#include "instrument_guard.h"
#include "keepout/control/crtk_session.h"

namespace keepout::python {
namespace {

LengthUnit unit_of(const std::string& name, std::string_view argument) {
  if (name == "m") return LengthUnit::metre;
  if (name == "mm") return LengthUnit::millimetre;
  refuse(argument, "'m' or 'mm'", "'" + name + "'");
}

/// The registration of a session, whose units stay when the matrix changes.
Registration registration_of(const py::object& matrix, const RegistrationUnits& units) {
  const Doubles numbers = doubles(matrix, {"mesh_from_robot", {4, 4}, "(4, 4)"});
  const Eigen::Matrix4d homogeneous =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  return Registration::mesh_from_robot(homogeneous, units);
}

/// A session as Python holds it.
struct Session {
  RegistrationUnits units;
  CrtkSession session;
};

std::unique_ptr<Session> make(const py::object& guard, const py::object& mesh_from_robot,
                              const std::string& robot_unit, const std::string& mesh_unit,
                              std::optional<double> period, CrtkOptions options) {
  const LengthUnit of_mesh = unit_of(mesh_unit, "mesh_unit");
  const RegistrationUnits units{of_mesh, unit_of(robot_unit, "robot_unit"), of_mesh};
  const Registration registration = registration_of(mesh_from_robot, units);
  options.haptic.period = period.value_or(options.haptic.period);
  if (py::isinstance<Guard>(guard)) {
    const auto& tip = guard.cast<const Guard&>();
    options.haptic.guides = tip.guides();
    return std::make_unique<Session>(units, CrtkSession(tip.another(), registration, options));
  }
  if (!py::isinstance<InstrumentGuard>(guard)) {
    refuse("guard", "a keepout.MotionConstraint or InstrumentGuard", type_name(guard));
  }
  const auto& instrument = guard.cast<const InstrumentGuard&>();
  if (!period) options.haptic.period = instrument.settings().options.period;
  return std::make_unique<Session>(units, CrtkSession(instrument.another(), registration, options));
}

std::span<const double> joints_of(const Doubles& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// Refuses a message if its mailbox throws: the next tick stands still.
class RefusedUnlessTaken {
 public:
  explicit RefusedUnlessTaken(CrtkSession& session) noexcept : session_(session) {}
  RefusedUnlessTaken(const RefusedUnlessTaken&) = delete;
  RefusedUnlessTaken& operator=(const RefusedUnlessTaken&) = delete;
  ~RefusedUnlessTaken() {
    if (std::uncaught_exceptions() > before_) session_.refuse(CycleStatus::invalid_pose);
  }

 private:
  CrtkSession& session_;
  int before_ = std::uncaught_exceptions();
};

/// Adds a mailbox for poses.
template <auto receive, class Type>
void bind_pose(Type& type, const char* name, const char* doc) {
  type.def(
      name,
      [](Session& self, const py::object& pose, double stamp, const std::string& frame) {
        const RefusedUnlessTaken refused(self.session);
        if (pose.is_none()) refuse("pose", "a homogeneous matrix (4, 4)", "None");
        (self.session.*receive)(pose_of(pose, "pose"), {stamp, frame});
      },
      py::arg("pose"), py::arg("stamp"), py::arg("frame") = "", doc);
}

/// Adds a mailbox for one number for each joint.
template <auto receive, class Type>
void bind_joints(Type& type, const char* name, const char* doc) {
  type.def(
      name,
      [](Session& self, const py::object& joints, double stamp) {
        const RefusedUnlessTaken refused(self.session);
        (self.session.*receive)(joints_of(doubles(joints, {"joints", {any}, "(n,)"})), {stamp});
      },
      py::arg("joints"), py::arg("stamp"), doc);
}

constexpr const char* session_doc =
    R"(A motion constraint between a teleoperation and a robot, with the interface of CRTK
(Collaborative Robotics Toolkit). Has no transport: pass what has arrived to on_...(), call tick()
once each period, and send setpoint_cp or setpoint_jp to the robot.

    session = keepout.CrtkSession(guard, mesh_from_robot)
    session.engage(now)                              # at the start, and after clutching
    session.on_measured_cp(pose, now); session.on_servo_cp(goal, now)
    session.tick(now)                                # 'guarded', or the cause of no motion

A message that is refused, or raises Error, makes the next tick stand still with its cause. A session has a constraint
of its own, like that of the guard when the session was made.

guard: a MotionConstraint, for a tip, or an InstrumentGuard. For an instrument, the chain's world is
the robot's frame in the unit of the mesh.
mesh_from_robot: (4, 4), from the robot's frame to that of the mesh; its translation is in mesh_unit.
robot_unit, mesh_unit: 'm' or 'mm'. Poses and prismatic joints of messages are in robot_unit.
period: of tick() [s]; None: 0.001, or that of the InstrumentGuard.
stiffness [N/length], damping [N s/length], largest_force [N]: of the spring to the hand.
top_speed: of the setpoint [length/s]. farthest: from setpoint to goal [length].
fade: time in which the force fades out when cycles fail [s].
largest_brake: of the passivity controller [N s/length]; 0: only observes.
motion_scale: displacement of the robot divided by that of the hand.
longest_silence: goals and measurements are used for this time [s].
farthest_lag: from setpoint to robot [length]. farthest_start: from the mesh at engage() [length].
frame: of the robot's poses; '': any.
needs_feedback: True if the robot must report that it is enabled and homed, and be measured.)";

void bind_mailboxes(py::class_<Session>& type) {
  type.def(
      "on_operating_state",
      [](Session& self, const std::string& state, bool is_homed) {
        const std::optional<OperatingState> known = operating_state_of(state);
        if (!known) self.session.on_operating_state(OperatingState::fault, false);
        if (!known)
          refuse("state", "'DISABLED', 'ENABLED', 'PAUSED' or 'FAULT'", "'" + state + "'");
        self.session.on_operating_state(*known, is_homed);
      },
      py::arg("state"), py::arg("is_homed").noconvert(),
      "Receives the robot's state: 'DISABLED', 'ENABLED', 'PAUSED' or 'FAULT'. Any other is taken "
      "as\n"
      "'FAULT', and raises Error.");
  bind_pose<&CrtkSession::on_measured_cp>(
      type, "on_measured_cp",
      "Receives the measured pose (4, 4) of the tool; only a session of a tip uses it. stamp: by\n"
      "the clock of tick() [s].");
  bind_pose<&CrtkSession::on_setpoint_cp>(
      type, "on_setpoint_cp",
      "Receives the robot's own setpoint (4, 4), where engage() starts; for a tip.");
  bind_pose<&CrtkSession::on_servo_cp>(type, "on_servo_cp",
                                       "Receives a goal for the pose (4, 4) of the tool.");
  bind_joints<&CrtkSession::on_measured_js>(type, "on_measured_js",
                                            "Receives the measured positions (n,) of the joints.");
  bind_joints<&CrtkSession::on_setpoint_js>(
      type, "on_setpoint_js",
      "Receives the robot's own setpoint (n,) of the joints, where engage() starts.");
  bind_joints<&CrtkSession::on_servo_jp>(
      type, "on_servo_jp",
      "Receives a goal for the positions (n,) of the joints; only for an instrument.");
  bind_joints<&CrtkSession::on_servo_jv>(
      type, "on_servo_jv",
      "Receives velocities (n,) of the joints [per second]; only for an instrument.");
  type.def(
      "on_contest", [](Session& self, bool is_contested) { self.session.on_contest(is_contested); },
      py::arg("is_contested").noconvert(),
      "Sets whether somebody else commands the robot. While True, the tool stands still.");
}

void bind_results(py::class_<Session>& type) {
  type.def_property_readonly(
          "setpoint_cp",
          [](const Session& self) -> std::optional<py::array_t<double>> {
            const std::optional<Pose>& pose = self.session.setpoint_cp();
            return pose ? std::optional(matrix_of(*pose)) : std::nullopt;
          },
          "(4, 4) float64: the pose to send to the robot, also after a failed cycle. None unless\n"
          "engaged.")
      .def_property_readonly(
          "setpoint_jp",
          [](const Session& self) {
            const std::span<const double> joints = self.session.setpoint_jp();
            return py::array_t<double>(static_cast<py::ssize_t>(joints.size()), joints.data());
          },
          "(n,) float64: the positions to send to the robot. Empty unless engaged, and for a tip.")
      .def_property_readonly(
          "servo_cf",
          [](const Session& self) {
            return py::array_t<double>(3, self.session.servo_cf().force.data());
          },
          "(3,) float64: the force to send to the hand's device [N].")
      .def_property_readonly(
          "engaged", [](const Session& self) { return self.session.engaged(); },
          "True if the session is engaged.")
      .def_property_readonly(
          "operating_state",
          [](const Session& self) { return name(self.session.operating_state()); },
          "The state to report to the teleoperation, such as 'ENABLED'.")
      .def_property_readonly(
          "status", [](const Session& self) { return name(self.session.cycle().status); },
          "The outcome of the last cycle, such as 'guarded'.")
      .def_property_readonly(
          "step_status",
          [](const Session& self) { return status_object(self.session.cycle().step); },
          "The Status of the last step; meaningful if status is 'guarded' or 'stopped'.")
      .def_property_readonly(
          "limits", [](const Session& self) { return names_of(self.session.cycle().limits); },
          "The limits of the last step: see Step.limits.")
      .def_property_readonly(
          "reason", [](const Session& self) { return self.session.reason(); },
          "One line on the last cycle and what to do about it.")
      .def("__repr__", [](const Session& self) {
        return py::str("<keepout.CrtkSession of {}: {}>")
            .format(self.session.tip() != nullptr ? "a tip" : "an instrument",
                    name(self.session.cycle().status));
      });
}

}  // namespace

void bind_session(py::module_& module) {
  const CrtkOptions usual;
  const HapticOptions& haptic = usual.haptic;
  py::class_<Session> type(module, "CrtkSession", session_doc);
  type.def(py::init([](const py::object& guard, const py::object& mesh_from_robot,
                       const std::string& robot_unit, const std::string& mesh_unit,
                       std::optional<double> period, double stiffness, double damping,
                       double largest_force, double top_speed, double farthest, double fade,
                       double largest_brake, double motion_scale, double longest_silence,
                       double farthest_lag, double farthest_start, const std::string& frame,
                       bool needs_feedback) {
             return make(guard, mesh_from_robot, robot_unit, mesh_unit, period,
                         {.haptic = {.spring = {.stiffness = stiffness,
                                                .damping = damping,
                                                .largest_force = largest_force},
                                     .top_speed = top_speed,
                                     .farthest = farthest,
                                     .fade = fade,
                                     .largest_brake = largest_brake},
                          .motion_scale = motion_scale,
                          .longest_silence = longest_silence,
                          .farthest_lag = farthest_lag,
                          .farthest_start = farthest_start,
                          .frame = frame,
                          .needs_feedback = needs_feedback});
           }),
           py::arg("guard"), py::arg("mesh_from_robot"), py::kw_only(), py::arg("robot_unit") = "m",
           py::arg("mesh_unit") = "mm", py::arg("period") = py::none(),
           py::arg("stiffness") = haptic.spring.stiffness,
           py::arg("damping") = haptic.spring.damping,
           py::arg("largest_force") = haptic.spring.largest_force,
           py::arg("top_speed") = haptic.top_speed, py::arg("farthest") = haptic.farthest,
           py::arg("fade") = haptic.fade, py::arg("largest_brake") = haptic.largest_brake,
           py::arg("motion_scale") = usual.motion_scale,
           py::arg("longest_silence") = usual.longest_silence,
           py::arg("farthest_lag") = usual.farthest_lag,
           py::arg("farthest_start") = usual.farthest_start, py::arg("frame") = "",
           py::arg("needs_feedback") = true);
  bind_mailboxes(type);
  type.def(
          "engage", [](Session& self, double now) { return name(self.session.engage(now)); },
          py::arg("now"),
          "Engages at the robot's own setpoint, so that the robot does not jump. Returns\n"
          "'guarded', or the cause why it does not engage. now: the time [s].")
      .def(
          "release", [](Session& self) { self.session.release(); },
          "Releases, for example when the clutch is pressed: no setpoint and no force.")
      .def(
          "set_registration",
          [](Session& self, const py::object& mesh_from_robot) {
            self.session.set_registration(registration_of(mesh_from_robot, self.units));
          },
          py::arg("mesh_from_robot"),
          "Releases, and replaces the registration (4, 4). The index is not rebuilt.")
      .def(
          "tick", [](Session& self, double now) { return name(self.session.tick(now)); },
          py::arg("now"),
          "Runs one cycle towards the last goal, once each period. Returns 'guarded' if the\n"
          "setpoint followed, else the cause: see docs/controllers.md. now: the time [s].");
  bind_results(type);
}

}  // namespace keepout::python
