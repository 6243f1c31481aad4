// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <string>

#include "keepout/index/spatial_index.h"
#include "mesh_handle.h"

namespace keepout::python {

namespace py = pybind11;

/// An index and the mesh it is built on, shared by all that use it.
class IndexHandle {
 public:
  /// `mesh`: a keepout.Mesh. Builds the index of that name, without Python's lock. `cache`: a
  /// folder for built indices; empty for none.
  IndexHandle(py::object mesh, std::string name, const std::filesystem::path& cache);

  const py::object& mesh_object() const noexcept { return mesh_object_; }
  const std::shared_ptr<const Mesh>& mesh() const noexcept { return mesh_; }
  const std::shared_ptr<const SpatialIndex>& shared() const noexcept { return index_; }
  const SpatialIndex& index() const noexcept { return *index_; }
  const std::string& name() const noexcept { return name_; }

 private:
  py::object mesh_object_;
  std::shared_ptr<const Mesh> mesh_;
  std::string name_;
  std::shared_ptr<const SpatialIndex> index_;
};

}  // namespace keepout::python
