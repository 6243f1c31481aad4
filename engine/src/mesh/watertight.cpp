// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/watertight.h"

#include "half_edges.h"

namespace keepout {

bool is_watertight(const Mesh& mesh) {
  bool has_edges = false;
  bool all_paired = true;
  for_each_edge(mesh, [&](VertexId, std::span<const HalfEdge> sides) {
    has_edges = true;
    all_paired = all_paired && sides.size() == 2 && sides[0].upwards != sides[1].upwards;
  });
  return has_edges && all_paired;
}

}  // namespace keepout
