// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "instrument_guard.h"

namespace keepout::python {

void bind_instrument_results(py::module_& module) {
  using Result = InstrumentStepResult;
  py::class_<Result> step(
      module, "InstrumentStep",
      "What one cycle of an instrument may do. Arrays are read-only views of it.");
  bind_step_result(step, "Whether there is a motion that may be carried out; it may be zero.");
  step.def_readonly("fraction", &Result::fraction,
                    "How much of the motion that was found is made: below 1 when it was cut short.")
      .def_readonly("rounds", &Result::rounds, "How often a trial motion was judged.")
      .def_readonly("rows", &Result::rows,
                    "How many rows hold the motion back, joint limits apart.")
      .def_readonly(
          "distance", &Result::distance,
          "From the body nearest to the mesh, as the cycle began [length]; None where none is\n"
          "closer than the margin and its band, negative where it reaches through the surface.")
      .def_property_readonly(
          "nearest",
          [](const Result& self) {
            return self.nearest < 0 ? std::nullopt : std::optional(self.nearest);
          },
          "The number of that body; None where there is no distance.")
      .def_property_readonly(
          "nearest_mesh",
          [](const Result& self) {
            return self.nearest_mesh < 0 ? std::nullopt : std::optional(self.nearest_mesh);
          },
          "The number of the mesh that it is nearest to; None where there is no distance.")
      .def_readonly(
          "clearance_fraction", &Result::clearance_fraction,
          "How much could be kept of what is certified otherwise: below 1 where a mesh came on\n"
          "faster than the joints can give way.")
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
          "The pairs of body and mesh that keep less than is certified for them: a tuple of\n"
          "(body, mesh, fraction); fraction is None if nothing is certified for the pair.")
      .def("__repr__", [](const Result& self) {
        return py::str("<keepout.InstrumentStep: {}, increment {}>")
            .format(name(self.status), py::cast(self.increment));
      });

  py::class_<MotionProof> proof(module, "MotionProof", "How much of a motion is certified.");
  bind_ending(proof,
              "How it ended: a Status; 'recovering' where some body is too close as it starts.");
  proof
      .def_readonly("fraction", &MotionProof::fraction,
                    "Proven is the motion from its start to here: 1 if all of it is.")
      .def_readonly("distance", &MotionProof::distance,
                    "As that of an InstrumentStep, at the start [length].")
      .def_property_readonly("is_clear", &MotionProof::is_clear,
                             "Whether the whole margin, less its band, is kept on all of it.")
      .def("__repr__", [](const MotionProof& self) {
        return py::str("<keepout.MotionProof: {}, fraction {:g}>")
            .format(name(self.status), self.fraction);
      });
}

}  // namespace keepout::python
