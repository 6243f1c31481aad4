// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "keepout/mesh/load_mesh.h"
#include "keepout/mesh/mesh.h"

namespace keepout::python {

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

}  // namespace keepout::python
