// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "keepout/mesh/mesh.h"

namespace keepout::app {

/// What the indices are compared on.
struct IndexComparison {
  std::string mesh_name;
  std::shared_ptr<const Mesh> mesh;
  std::vector<std::string> indices, activations;
  std::size_t poses = 100;
  double radius = 1.0;  // of the motion sphere [mm]
  std::uint64_t seed = 1;
};

/// Builds the motion constraint that make_motion_constraint gives, with each index and each rule,
/// and holds what the index finds around the tip, the planes and the steps to brute force, and
/// closest points to exact arithmetic. Half of the poses are in contact, the others off the
/// surface, on vertices and on edges. `done` is told of each pose, of brute force and of each
/// index, under each rule. Up to the row during which it was stopped.
std::vector<IndexAgreement> compare_indices(const IndexComparison& comparison,
                                            const std::function<void()>& done,
                                            const Stopped& stopped = never);

}  // namespace keepout::app
