// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "../tree.h"

namespace keepout {

/// The leaves of a node, and their vertices. If there are fewer, the last ones are repeated.
struct SixteenLeaves {
  LeafBlock leaf[NodeBlock::lanes];
  LeafPoints points[NodeBlock::lanes];
};

/// Computes boxes and cylinders around the floats of leaves, in all lanes. The axis of a cylinder
/// is the mean normal of the triangles.
void enclose(const SixteenLeaves& leaves, NodeBlock& boxes, CylinderBlock& cylinders) noexcept;

/// Computes a box and a cylinder around a node's boxes and cylinders, in a lane of the blocks above
/// it.
void enclose(const NodeBlock& node, const CylinderBlock& of_node, NodeBlock& boxes,
             CylinderBlock& cylinders, std::size_t lane) noexcept;

/// Sets an unused lane to numbers that are safe in arithmetic.
void close_lane(CylinderBlock& cylinders, std::size_t lane) noexcept;

}  // namespace keepout
