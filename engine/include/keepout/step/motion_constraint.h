// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/activation/activation.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/step/step.h"

namespace keepout {

/// Keeps a tool tip out of a mesh: owns an index, a rule, a solver and their memory, by whatever
/// names they were made. Not thread-safe: one for each control loop; the mesh is shared.
class MotionConstraint {
 public:
  /// Index and rule must be built on `mesh`. Throws Error when a part is missing, or an option or
  /// capacity is out of range. Makes all memory here.
  MotionConstraint(std::shared_ptr<const Mesh> mesh, std::unique_ptr<SpatialIndex> index,
                   std::unique_ptr<Activation> activation, std::unique_ptr<Solver> solver,
                   const StepOptions& options, const Capacity& capacity = {});

  /// The nearest motion that the planes allow. The result's views stay valid until the next step.
  Step step(const Motion& motion) noexcept;

  /// The same, and what each stage took.
  Step step(const Motion& motion, StageTimes& times) noexcept;

  const Mesh& mesh() const noexcept { return *mesh_; }

 private:
  std::shared_ptr<const Mesh> mesh_;
  std::unique_ptr<SpatialIndex> index_;
  std::unique_ptr<Activation> activation_;
  std::unique_ptr<Solver> solver_;
  StepOptions options_;
  Workspace work_;
};

}  // namespace keepout
