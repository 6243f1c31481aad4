// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <vector>

#include "bindings.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/solvers/registry.h"

namespace keepout::python {
namespace {

/// A table of parts as a list of keepout.Part.
template <class Table>
py::list parts_of(const Table& table) {
  const py::object part = py::module_::import("keepout._results").attr("Part");
  py::list parts;
  for (const auto& entry : table) parts.append(part(entry.name, entry.description));
  return parts;
}

}  // namespace

void bind_parts(py::module_& module) {
  module.def(
      "indices", [] { return parts_of(index_backends()); },
      "The spatial indices of this build: a list of Part(name, description).");
  module.def(
      "activations", [] { return parts_of(activation_rules()); },
      "The activation rules, which turn triangles into planes: a list of Part.");
  module.def(
      "solvers", [] { return parts_of(solver_backends()); },
      "The solvers of the step problem in this build: a list of Part.");
}

}  // namespace keepout::python
