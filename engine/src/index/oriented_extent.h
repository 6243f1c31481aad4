// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/index/leaf_block.h"
#include "keepout/index/pd_tree.h"

namespace keepout {

/// How far leaves extend along three directions, from `node.center`: low <= 0 <= high, to the
/// rounding of floats. [length]
struct OrientedExtent {
  float low[3];
  float high[3];
};

OrientedExtent oriented_extent(const PdNode& node, std::span<const LeafBlock> leaves) noexcept;

}  // namespace keepout
