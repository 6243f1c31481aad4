// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/pybind11.h>

#include <exception>
#include <string_view>

#include "bindings.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "keepout/error.h"
#include "keepout/solvers/registry.h"
#include "keepout/version.h"

namespace keepout::python {
namespace {

/// Returns a table of parts as a list of keepout.Part.
template <class Table>
py::list parts_of(const Table& table) {
  const py::object part = py::module_::import("keepout._results").attr("Part");
  py::list parts;
  for (const auto& entry : table) parts.append(part(entry.name, entry.description));
  return parts;
}

void bind_error(py::module_& module) {
  auto error = py::register_exception<Error>(module, "Error", PyExc_ValueError);
  // The message may contain a file name that is not UTF-8.
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
  error.doc() =
      "An invalid argument, file or setting. The message says what is wrong and what to do.";
}

void bind_parts(py::module_& module) {
  module.def(
      "indices", [] { return parts_of(index_backends()); },
      "Returns the spatial indices of this build: a list of Part(name, description).");
  module.def(
      "activations", [] { return parts_of(activation_rules()); },
      "Returns the activation rules, which turn triangles into planes: a list of Part.");
  module.def(
      "solvers", [] { return parts_of(solver_backends()); },
      "Returns the solvers of the step problem in this build: a list of Part.");
  module.def(
      "narrow_phases", [] { return parts_of(narrow_phase_backends()); },
      "Returns the narrow phases of this build, for a ConvexTool: a list of Part.");
}

}  // namespace
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
  bind_options(module);
  bind_index(module);
  bind_planes(module);
  bind_guides(module);
  bind_step(module);
  bind_convex_tool(module);
  bind_motion_constraint(module);
  bind_chain(module);
  bind_instrument(module);
  bind_instrument_results(module);
  bind_instrument_guard(module);
  bind_registration(module);
  bind_session(module);
  explain_call_errors(module);
}
