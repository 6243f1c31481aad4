// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

namespace keepout::python {

namespace py = pybind11;

// Each adds one concept to the module; the order matters where one is an argument of the next.
void bind_status(py::module_& module);
void bind_mesh(py::module_& module);
void bind_inspection(py::module_& module);  // adds Mesh.inspect
void bind_index(py::module_& module);
void bind_planes(py::module_& module);
void bind_step(py::module_& module);
void bind_motion_constraint(py::module_& module);

}  // namespace keepout::python
