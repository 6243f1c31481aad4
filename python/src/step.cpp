// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <string>

#include "bindings.h"
#include "status_object.h"
#include "step_result.h"
#include "views.h"

namespace keepout::python {

StepResult::StepResult(const Step& step)
    : status(step.status),
      motion(step.motion),
      increment(step.increment.begin(), step.increment.end()),
      planes{{step.planes.begin(), step.planes.end()}},
      active(step.active.begin(), step.active.end()),
      triangles(step.triangles),
      distance(step.distance) {}

void bind_step(py::module_& module) {
  py::class_<StepResult>(module, "Step",
                         "What one control cycle may do. Arrays are read-only views of it.")
      .def_property_readonly(
          "status", [](const StepResult& self) { return status_object(self.status); },
          "How the step ended: a Status.")
      .def_property_readonly(
          "ok", [](const StepResult& self) { return is_ok(self.status); },
          "Whether the motion may be carried out; it may be zero.")
      .def_property_readonly(
          "reason", [](const StepResult& self) { return reason(self.status); },
          "One line on what happened and what to do about it.")
      .def_property_readonly(
          "motion",
          [](const py::object& self) {
            return view(self.cast<const StepResult&>().motion.data(), {3}, {sizeof(double)}, self);
          },
          "(3,) float64 [length]: of the tip; zero unless ok.")
      .def_property_readonly(
          "increment",
          [](const py::object& self) {
            return view(self.cast<const StepResult&>().increment, self);
          },
          "(n,) float64: of the joints with a Jacobian [their unit], else of the tip [length];\n"
          "empty unless ok.")
      .def_readonly("planes", &StepResult::planes,
                    "All planes that were posed to the solver: Planes.")
      .def_property_readonly(
          "active",
          [](const py::object& self) { return view(self.cast<const StepResult&>().active, self); },
          "(a,) uint32: which planes hold the motion back, by position; from len(planes) on, rows.")
      .def_readonly("triangles", &StepResult::triangles, "How many triangles the step rests on.")
      .def_readonly(
          "distance", &StepResult::distance,
          "From the tip, as the step began, to the nearest triangle [length]; None where the\n"
          "rule does not come by it, unless the constraint was made with "
          "distances='always'.")
      .def("__repr__", [](const StepResult& self) {
        const auto number = [](double value) {
          return py::repr(py::float_(value)).cast<std::string>();
        };
        return "<keepout.Step: " + std::string(name(self.status)) + ", motion (" +
               number(self.motion.x()) + ", " + number(self.motion.y()) + ", " +
               number(self.motion.z()) + ")>";
      });
}

}  // namespace keepout::python
