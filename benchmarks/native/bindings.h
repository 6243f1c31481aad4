// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <utility>

#include "judge.h"

namespace keepout::peers {

/// Triangles as an array: the numbers of three vertices in each row.
using CornerRows = Eigen::Matrix<std::uint32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// Releases Python's lock during a call.
using Unlocked = pybind11::call_guard<pybind11::gil_scoped_release>;

/// Returns the mesh of two arrays.
inline Mesh mesh_of(const RowsRef& vertices, const Eigen::Ref<const CornerRows>& triangles) {
  Surface surface;
  for (const auto& v : vertices.rowwise()) surface.vertices.emplace_back(v);
  for (const auto& t : triangles.rowwise()) surface.triangles.push_back({t[0], t[1], t[2]});
  return Mesh(std::move(surface));
}

/// Adds the rules of C++, and the fields and libraries that they use.
void bind_rules(pybind11::module_& module);

/// Adds the simulated hands, and the loop that pushes a tip.
void bind_pushes(pybind11::module_& module);

/// Adds the loop of a trial.
void bind_trials(pybind11::module_& module);

}  // namespace keepout::peers
