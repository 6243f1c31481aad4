// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <array>
#include <string>
#include <vector>

#include "arguments.h"
#include "bindings.h"
#include "status_object.h"

namespace keepout::python {
namespace {

constexpr std::size_t status_count = static_cast<std::size_t>(Status::margin_too_small) + 1;

/// Never released: the interpreter may be gone before our statics are.
std::array<PyObject*, status_count> members{};

Status status_from(py::ssize_t value) {
  if (value < 0 || static_cast<std::size_t>(value) >= status_count) {
    refuse("status", "0 to " + std::to_string(status_count - 1), std::to_string(value));
  }
  return static_cast<Status>(value);
}

}  // namespace

py::object status_object(Status status) {
  return py::reinterpret_borrow<py::object>(members[static_cast<std::size_t>(status)]);
}

void bind_status(py::module_& module) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < status_count; ++i) {
    names.emplace_back(name(static_cast<Status>(i)));
  }
  module.attr("status_names") = py::tuple(py::cast(names));
  module.def(
      "status_reason", [](py::ssize_t value) { return reason(status_from(value)); },
      py::arg("status"), "One line on what a status means and what to do about it.");
  // The enumeration is Python's own, as that is what numpy compares quickly.
  const py::object type = py::module_::import("keepout._status").attr("Status");
  for (std::size_t i = 0; i < status_count; ++i) members[i] = type(i).release().ptr();
}

}  // namespace keepout::python
