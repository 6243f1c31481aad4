// SPDX-License-Identifier: BSD-3-Clause
#include "keywords.h"

#include "keepout/registry.h"

namespace keepout::python {

void refuse_others(std::string_view type, const py::kwargs& others,
                   std::span<const std::string_view> arguments) {
  if (others.empty()) return;
  const auto name = py::str(others.begin()->first).cast<std::string>();
  std::string known;
  for (const std::string_view argument : arguments) {
    known += (known.empty() ? "" : ", ") + std::string(argument);
  }
  const auto meant = nearest_name(name, arguments);
  throw py::type_error(std::string(type) + " has no argument '" + name + "'" +
                       (meant ? "; did you mean '" + std::string(*meant) + "'?" : ";") +
                       " known: " + known);
}

}  // namespace keepout::python
