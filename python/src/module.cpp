// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/pybind11.h>

#include <exception>
#include <string_view>

#include "bindings.h"
#include "keepout/error.h"
#include "keepout/version.h"

namespace keepout::python {

void bind_error(py::module_& module) {
  auto error = py::register_exception<Error>(module, "Error", PyExc_ValueError);
  // A message may name a file, whose name need not be UTF-8.
  static PyObject* const type = error.inc_ref().ptr();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& failure) {
      const std::string_view text = failure.what();
      const auto message = py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(
          text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape"));
      if (message) PyErr_SetObject(type, message.ptr());
    }
  });
  error.doc() = "What is wrong with an argument, a file or a setting, and what to do about it.";
}

}  // namespace keepout::python

PYBIND11_MODULE(_core, module) {
  using namespace keepout::python;
  module.doc() = "The compiled part of keepout; import keepout instead.";
  module.attr("__version__") = KEEPOUT_VERSION;
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
