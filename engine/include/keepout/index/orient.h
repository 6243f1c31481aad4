// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// The result of orient(). A part is a maximal set of triangles that are connected by edges with
/// exactly two triangles.
struct Orientation {
  std::size_t turned = 0;       // triangles whose winding changed
  std::size_t disagreeing = 0;  // triangles whose winding differed from most of their part
  std::size_t parts = 0;        // the sum of the five kinds below

  std::size_t closed_parts = 0;        // wind around a volume
  std::size_t open_parts = 0;          // have edges with one triangle: free side unknown
  std::size_t non_manifold_parts = 0;  // have edges with three triangles or more: free side unknown
  std::size_t flat_parts = 0;       // closed, but enclose no volume, such as two coincident layers
  std::size_t one_sided_parts = 0;  // no winding is consistent, as on a Möbius strip: unchanged

  std::size_t inside_out_parts = 0;  // closed, not nested; all triangles were turned
  std::size_t crossing_parts = 0;    // closed, partly within a larger closed part; not nested
  std::size_t nested_parts = 0;      // closed, within another closed part; turned if that was
};

/// Turns triangles (reverses their winding) so that the two triangles of each edge have consistent
/// winding. Also turns closed parts that do not face outward by their signed volume. Most triangles
/// of a part keep their winding, unless the part is closed and inside out. A closed part within
/// another may bound a cavity or a solid: it keeps its winding relative to the outermost part
/// around it. A part with vertices on both sides of another part bounds no cavity, so it faces
/// outward. Precondition: the surface is welded. Throws Error like Mesh.
Orientation orient(Surface& surface);

}  // namespace keepout
