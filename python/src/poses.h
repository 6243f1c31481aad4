// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string_view>

#include "keepout/geometry/pose.h"

namespace keepout::python {

namespace py = pybind11;

// Poses as Python has them: homogeneous matrices of doubles, (4, 4), row by row.

/// What such a matrix says; None is the identity. Whether it turns is looked at by who takes it.
Pose pose_of(const py::object& matrix, std::string_view name);

/// Writes the sixteen numbers of one.
void write(double* to, const Pose& pose);

/// A matrix of its own.
py::array_t<double> matrix_of(const Pose& pose);

}  // namespace keepout::python
