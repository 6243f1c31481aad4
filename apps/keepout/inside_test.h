// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout::app {

/// Whether a point is inside a closed surface, by counting how often a ray along x leaves it.
///
/// Independent of everything that the fixture decides with: no tree, no closest point, no normal,
/// no winding. Triangles are filed in a grid over (y, z). Each edge is tested on its own vertices
/// in one fixed order, so the two triangles beside it agree, to the bit, on which side the ray
/// passes: no ray slips through a seam or counts it twice.
class InsideTest {
 public:
  explicit InsideTest(const Mesh& mesh);

  /// Precondition: the mesh is closed (each edge has an even number of triangles).
  bool operator()(const Vec3& point) const;

 private:
  std::size_t column(int axis, double coordinate) const;

  const Mesh* mesh_;
  Box bounds_;
  std::array<std::size_t, 2> cells_;  // along y and z
  std::array<double, 2> cell_size_;   // [length]
  std::vector<std::size_t> begin_;    // of each cell's triangles
  std::vector<TriangleId> triangles_;
};

}  // namespace keepout::app
