// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "arrays.h"

namespace keepout::python {

namespace py = pybind11;

/// One of two values, by name. Throws Error, naming the argument, for another name.
template <class Enum>
Enum named(std::string_view argument, const std::string& given,
           const std::array<std::pair<std::string, Enum>, 2>& names) {
  for (const auto& [name, value] : names) {
    if (given == name) return value;
  }
  refuse(argument, "'" + names[0].first + "' or '" + names[1].first + "'", "'" + given + "'");
}

/// What Python says of a keyword that a class has not, and which of `arguments` may have been
/// meant. Throws TypeError unless there are no others.
void refuse_others(std::string_view type, const py::kwargs& others,
                   std::span<const std::string_view> arguments);

}  // namespace keepout::python
