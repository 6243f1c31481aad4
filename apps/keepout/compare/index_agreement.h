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
  double radius = 1.0;  // of the motion sphere, for the rules that look at all of it [mm]
  double margin = 0.2;  // of the certified rule [mm]
  std::uint64_t seed = 1;
};

/// Asks every index the same under every rule, and holds what it finds, the planes and the steps to
/// brute force, and closest points to exact arithmetic. Half of the poses are in contact, the
/// others off the surface, on vertices and on edges. `done` is told of each
/// pose, of brute force and of each index, under each rule.
std::vector<IndexAgreement> compare_indices(const IndexComparison& comparison,
                                            const std::function<void()>& done);

}  // namespace keepout::app
