// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "keepout/activation/activation.h"
#include "keepout/index/refine.h"
#include "keepout/index/spatial_index.h"
#include "keepout/step/motion.h"
#include "keepout/step/problem.h"

namespace keepout {

/// Room for the largest step that shall be solved; a step that needs more ends with over_capacity.
struct Capacity {
  std::size_t triangles = std::size_t{1} << 16;  // candidates of one query
  std::size_t planes = std::size_t{1} << 14;
  std::size_t variables = 7;  // columns of the Jacobian, or 3 without one
};

/// All the memory of a step, made once. One for each thread.
class Workspace {
 public:
  explicit Workspace(const Capacity& capacity);

  Eigen::Index variables() const noexcept { return variables_; }

  /// The problem whose rows are the planes: on the tip's own increment without a Jacobian, on the
  /// joints' with one, n^T J. Precondition: at most variables() joints.
  StepProblem pose(const Motion& motion, double damping) noexcept;

  TriangleBuffer candidates;
  HitBuffer hits;
  HalfSpaceBuffer planes;
  Solution solution;

 private:
  Eigen::Index variables_;
  std::vector<double> rows_;    // (planes, variables), row by row
  std::vector<double> bounds_;  // (planes)
  Vec3 desired_;
};

}  // namespace keepout
