// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/numpy.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "bindings.h"
#include "python_rule.h"
#include "trial/hand.h"
#include "trial/loop.h"

namespace keepout::trial {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

double number(const py::handle& of, const char* name) { return of.attr(name).cast<double>(); }

std::vector<double> numbers(const py::handle& array) {
  const auto doubles = array.cast<Doubles>();
  return {doubles.data(), doubles.data() + doubles.size()};
}

std::vector<Vec3> points(const py::handle& array) {
  const std::vector<double> flat = numbers(array);
  std::vector<Vec3> out(flat.size() / 3);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = Vec3(flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]);
  }
  return out;
}

Vec3 point(const py::handle& array) { return points(array).at(0); }

/// Returns a table whose rows are those of the last axis.
Table table(const py::handle& array) {
  const auto shape = array.attr("shape").cast<std::vector<std::size_t>>();
  Table out{numbers(array), 1, shape.back()};
  out.rows = out.numbers.size() / out.columns;
  return out;
}

py::array_t<double> array_of(const std::vector<Vec3>& rows) {
  py::array_t<double> out({static_cast<py::ssize_t>(rows.size()), py::ssize_t{3}});
  double* to = out.mutable_data();
  for (const Vec3& row : rows) to = std::copy_n(row.data(), 3, to);
  return out;
}

py::array_t<double> array_of(const std::vector<double>& values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

Path path_of(const py::object& path) {
  return {points(path.attr("points")), points(path.attr("up")),     numbers(path.attr("order")),
          point(path.attr("across")),  point(path.attr("heading")), number(path, "spacing"),
          number(path, "length")};
}

RigidMotion motion_of(const py::object& motion) {
  return {points(motion.attr("rotation")), point(motion.attr("translation"))};
}

std::unique_ptr<Hand> hand_of(const py::object& hand, const HandSettings& settings,
                              const py::dict& draws) {
  if (draws.contains("errors")) {
    const double samples = draws["samples"].cast<double>();
    return make_hand(OpenLoop{number(hand, "tolerance"), number(hand, "leaning"), samples,
                              table(draws["errors"])},
                     settings);
  }
  const Vec3 heading = point(draws["heading"]);
  const auto looks = draws["motor"].attr("shape").cast<std::vector<std::size_t>>()[1];
  return make_hand(Intermittent{number(hand, "refractory"),
                                number(hand, "movement"),
                                number(hand, "noise"),
                                number(hand, "drift"),
                                number(hand, "sight_across"),
                                number(hand, "sight_in_depth"),
                                number(hand, "lasting"),
                                number(hand, "tolerance"),
                                number(hand, "touch"),
                                number(hand, "lift"),
                                {heading[0], heading[1], heading[2]},
                                table(draws["motor"]),
                                table(draws["sight"]),
                                table(draws["view"]),
                                looks},
                   settings);
}

py::dict run_trial(const py::object& course, const py::object& rule, const py::object& op,
                   const py::object& setup, const py::object& registered,
                   const py::object& true_frame, const py::dict& draws) {
  const py::module_ names = py::module_::import("experiments.trial");
  const py::object bone = course.attr("bone");
  Settings s{path_of(course.attr("path")),
             std::nullopt,
             number(course, "force_per_mm"),
             number(course, "greatest_force"),
             number(course, "radius"),
             number(course, "top_speed"),
             number(course, "period"),
             course.attr("cycles").cast<int>(),
             number(names, "APPROACH"),
             number(names, "NEAR_THE_END"),
             number(names, "START_HEIGHT"),
             number(op, "motion_scale"),
             number(op, "mass"),
             number(op, "stiffness"),
             number(op, "damping"),
             number(setup, "latency"),
             number(setup, "lag"),
             number(setup, "tip_stiffness"),
             motion_of(registered),
             motion_of(true_frame),
             points(draws["tremor"])};
  if (!bone.is_none()) {
    s.bone = BoneProperties{number(bone, "thickness"), number(bone, "resistance"),
                            number(bone, "behind"), number(bone, "blade"), number(bone, "kerf")};
  }
  const HandSettings settings{
      s.period,       number(course, "speed"),  number(course, "depth"), s.path.length,
      s.force_per_mm, number(op, "felt_force"), number(op, "reaction"),  s.bone.has_value(),
      !rule.is_none()};
  const std::unique_ptr<Hand> hand = hand_of(op.attr("hand"), settings, draws);
  const peers::RuleArgument fixture(rule);
  const Trace trace = [&] {
    const py::gil_scoped_release release;
    return run(s, *hand, fixture.rule());
  }();
  return py::dict("tip"_a = array_of(trace.tip), "setpoint"_a = array_of(trace.setpoint),
                  "goal"_a = array_of(trace.goal), "force"_a = array_of(trace.force),
                  "power"_a = array_of(trace.power), "contact"_a = array_of(trace.contact),
                  "kerf"_a = array_of(trace.kerf).reshape({trace.kerf_rows, trace.kerf_columns}),
                  "begun"_a = trace.begun, "finished"_a = trace.finished);
}

}  // namespace
}  // namespace keepout::trial

namespace keepout::peers {

void bind_trials(pybind11::module_& module) {
  using pybind11::literals::operator""_a;
  module.def("run_trial", &trial::run_trial, "course"_a, "rule"_a, "operator"_a, "setup"_a,
             "registered"_a, "true_frame"_a, "draws"_a,
             "Returns the members of a Trace of experiments/trial.py, without `registered`. The\n"
             "rule is of C++ or Python, or None. Runs without Python's lock, except in a rule of\n"
             "Python.");
}

}  // namespace keepout::peers
