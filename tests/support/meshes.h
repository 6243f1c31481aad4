// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string_view>
#include <utility>

#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

// Meshes as constraints and indices share them.

inline std::shared_ptr<const Mesh> mesh_of(Surface surface) {
  return std::make_shared<const Mesh>(std::move(surface));
}

/// Returns the generated shape of this name.
inline std::shared_ptr<const Mesh> mesh_of(std::string_view shape) {
  return mesh_of(make_shape(shape));
}

/// Returns one triangle in the plane x = `at`, larger than all that is near it.
inline std::shared_ptr<const Mesh> wall(double at) {
  return mesh_of(Surface{{{at, -300, -300}, {at, 300, -300}, {at, 0, 300}}, {{0, 1, 2}}});
}

/// Returns the vertex with the largest z.
inline Vec3 highest_vertex(const Mesh& mesh) {
  Vec3 top = mesh.vertex(0);
  for (const Vec3& v : mesh.vertices()) {
    if (v.z() > top.z()) top = v;
  }
  return top;
}

}  // namespace keepout
