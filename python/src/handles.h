// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/mesh/mesh.h"

namespace keepout::python {

namespace py = pybind11;

/// A mesh as Python holds it: with what its file had to say, and normals once they are asked for.
class MeshHandle {
 public:
  explicit MeshHandle(std::shared_ptr<const Mesh> mesh);
  explicit MeshHandle(LoadedMesh loaded);

  const std::shared_ptr<const Mesh>& shared() const noexcept { return mesh_; }
  const Mesh& mesh() const noexcept { return *mesh_; }
  const std::vector<std::string>& warnings() const noexcept { return warnings_; }
  AnatomicalSpace space() const noexcept { return space_; }

  /// One for each triangle. Made on the first call, which Python's lock keeps from being two.
  const std::vector<Vec3>& normals();

 private:
  std::shared_ptr<const Mesh> mesh_;
  std::vector<std::string> warnings_;
  AnatomicalSpace space_ = AnatomicalSpace::unstated;
  std::vector<Vec3> normals_;
};

/// The mesh of a keepout.Mesh. Throws Error for anything else.
const std::shared_ptr<const Mesh>& mesh_of(const py::object& mesh);

/// An index and the mesh it is built on, shared by all that use it.
class IndexHandle {
 public:
  /// `mesh`: a keepout.Mesh. Builds the index of that name, without Python's lock. `cache`: a
  /// folder for built indices, if they are to be kept. Throws Error where mesh_of does.
  IndexHandle(py::object mesh, std::string name, const std::optional<std::filesystem::path>& cache);

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
