// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "judge.h"

namespace keepout::peers {

/// Triangles as an array: the numbers of three vertices in each row.
using CornerRows = Eigen::Matrix<std::uint32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// Releases Python's lock during a call.
using Unlocked = pybind11::call_guard<pybind11::gil_scoped_release>;

/// Returns the enumerator with a name. Throws Error for an unknown name.
template <class Enum, std::size_t n>
Enum named(const std::array<std::string_view, n>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw Error("unknown name '" + name + "'");
  return static_cast<Enum>(found - names.begin());
}

/// Adds the rules of C++, and the fields and libraries that they use.
void bind_rules(pybind11::module_& module);

/// Adds the pushers, and the loop that pushes a tip.
void bind_pushes(pybind11::module_& module);

/// Adds the loop of a trial.
void bind_trials(pybind11::module_& module);

}  // namespace keepout::peers
