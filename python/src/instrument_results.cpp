// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "instrument_guard.h"

namespace keepout::python {

void bind_instrument_results(py::module_& module) {
  using Result = InstrumentStepResult;
  py::class_<Result> step(
      module, "InstrumentStep",
      "The result of one cycle of an instrument. Arrays are read-only views of it.");
  bind_step_result(step, "True if the increment may be executed; it may be zero.");
  step.def_readonly("fraction", &Result::fraction,
                    "`increment` as a fraction of the motion that the solver found; below 1\n"
                    "if the motion was truncated.")
      .def_readonly("rounds", &Result::rounds, "The number of trial motions that were judged.")
      .def_readonly("rows", &Result::rows,
                    "The number of rows that limit the motion, without joint limits.")
      .def_readonly(
          "distance", &Result::distance,
          "The distance from the nearest body to the mesh at the start of the cycle [length];\n"
          "below 0 if the body intersects the surface. None if no body is within margin +\n"
          "max(band, slowing_within), or if the work budget ended first.")
      .def_property_readonly(
          "nearest",
          [](const Result& self) {
            return self.nearest < 0 ? std::nullopt : std::optional(self.nearest);
          },
          "The number of the nearest body; None without a distance.")
      .def_property_readonly(
          "nearest_mesh",
          [](const Result& self) {
            return self.nearest_mesh < 0 ? std::nullopt : std::optional(self.nearest_mesh);
          },
          "The number of the mesh that is nearest to a body; None without a distance.")
      .def_readonly(
          "clearance_fraction", &Result::clearance_fraction,
          "The least clearance fraction of all bodies and meshes: below 1 if a mesh approaches\n"
          "faster than a body can retreat.")
      .def_property_readonly(
          "degraded",
          [](const Result& self) {
            py::list pairs;
            for (const DegradedClearance& pair : self.degraded) {
              const py::object fraction = pair.is_certified ? py::object(py::float_(pair.fraction))
                                                            : py::object(py::none());
              pairs.append(py::make_tuple(pair.body, pair.mesh, fraction));
            }
            return py::tuple(pairs);
          },
          "The pairs of a body and a mesh with less than their certified clearance: a tuple of\n"
          "(body, mesh, fraction). fraction is None if no clearance is certified for the pair.")
      .def("__repr__", [](const Result& self) {
        return py::str("<keepout.InstrumentStep: {}, increment {}>")
            .format(name(self.status), py::cast(self.increment));
      });

  py::class_<MotionProof> proof(module, "MotionProof", "The certified part of a motion.");
  bind_ending(proof, "The outcome: a Status; 'recovering' if a body is too close at the start.");
  proof
      .def_readonly("fraction", &MotionProof::fraction,
                    "The motion is proved from its start to this fraction; 1 for all of it.")
      .def_readonly("distance", &MotionProof::distance,
                    "Like InstrumentStep.distance, at the start [length].")
      .def_property_readonly("is_clear", &MotionProof::is_clear,
                             "True if each body stays at least margin - band away on the whole\n"
                             "motion.")
      .def("__repr__", [](const MotionProof& self) {
        return py::str("<keepout.MotionProof: {}, fraction {:g}>")
            .format(name(self.status), self.fraction);
      });
}

}  // namespace keepout::python
