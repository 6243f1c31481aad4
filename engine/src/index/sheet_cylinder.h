// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/index/cylinder_block.h"
#include "keepout/index/leaf_block.h"
#include "keepout/index/wide_bvh.h"

namespace keepout {

/// Puts a cylinder around a leaf's floats in a lane: its axis is their mean normal.
void enclose(const LeafBlock& leaf, CylinderBlock& cylinders, std::size_t lane) noexcept;

/// Puts one around a node's cylinders in a lane of the block above it.
void enclose(const NodeBlock& node, const CylinderBlock& of_node, CylinderBlock& above,
             std::size_t lane) noexcept;

/// Leaves no numbers in an unused lane that arithmetic would stumble over.
void close_lane(CylinderBlock& cylinders, std::size_t lane) noexcept;

}  // namespace keepout
