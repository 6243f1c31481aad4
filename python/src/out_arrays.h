// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>
#include <vector>

namespace keepout::python {

namespace py = pybind11;

/// Where a batch writes. The pointers are into arrays that `result` holds.
struct StepColumns {
  py::object result;  // keepout.Steps, or keepout.Simulation
  double* motions;    // (count, 3): of a simulation, the tips (loops, cycles + 1, 3)
  std::uint8_t* status;
  std::uint32_t* planes;
};

/// The arrays of `out`, a keepout.Steps for that many poses; or of a new one when it is None.
/// Throws Error unless each is of its type and shape, writeable, without gaps, and shares no memory
/// with another or with an input.
StepColumns steps_columns(const py::object& out, py::ssize_t poses,
                          const std::vector<py::array>& inputs);

/// The same of a keepout.Simulation.
StepColumns simulation_columns(const py::object& out, py::ssize_t loops, py::ssize_t cycles,
                               const std::vector<py::array>& inputs);

}  // namespace keepout::python
