// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/pybind11.h>

#include "bindings.h"
#include "keepout/error.h"

namespace keepout::python {

void bind_error(py::module_& module) {
  auto error = py::register_exception<Error>(module, "Error", PyExc_ValueError);
  error.doc() = "What is wrong with an argument, a file or a setting, and what to do about it.";
}

}  // namespace keepout::python

PYBIND11_MODULE(_core, module) {
  using namespace keepout::python;
  module.doc() = "The compiled part of keepout; import keepout instead.";
  module.attr("__version__") = KEEPOUT_VERSION;
  // Our docstrings name shapes and units; pybind11's line of types stands above.
  bind_error(module);
  bind_status(module);
  bind_inspection(module);
  bind_mesh(module);
  bind_parts(module);
  bind_index(module);
  bind_planes(module);
  bind_step(module);
  bind_motion_constraint(module);
}
