// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "bench/pipeline.h"
#include "bench/speed/indexed_mesh.h"
#include "keepout/activation/activation.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "keepout/step/solver.h"
#include "keepout/step/workspace.h"

namespace keepout::app {

/// How a rule gets at the triangles.
enum class Form : std::uint8_t {
  plain,     // the index hands them over, one step of the pipeline after the other
  searching  // it searches the index by itself, where there is such a form
};

/// A rule, a solver and their memory: asked one motion after another, as in a control loop.
class Stepper {
 public:
  /// Mesh and index must outlive this. Throws Error when there is no such part.
  Stepper(std::shared_ptr<const Mesh> mesh, const SpatialIndex& index, std::string_view rule,
          std::string_view solver, const StepOptions& options, Form form);

  Answer ask(const Motion& motion) noexcept;

  /// Whether it is the searching form that is asked.
  bool searches() const noexcept { return rule_->searches(); }

 private:
  std::shared_ptr<const Mesh> mesh_;
  const SpatialIndex& index_;
  std::unique_ptr<Activation> plain_;
  std::unique_ptr<Activation> searching_;
  Activation* rule_;
  std::unique_ptr<Solver> solver_;
  StepOptions options_;
  Workspace work_;
};

/// The certified rule, on our index and with our solver. [mm]
Stepper certified(const IndexedMesh& on, double margin, Form form);

/// The paper's rule, on our index and with our solver. [mm]
Stepper paper(const IndexedMesh& on, double radius, Form form);

/// Asks both for a sample of the motions. Empty if all answers were the same, bit for bit; else a
/// remark on how many were not.
std::string disagreement(Stepper& one, Stepper& other, std::span<const Motion> motions);

/// The same for solvers of which none is exact: status apart, motions may differ by `accuracy` of
/// the length of the one asked for.
std::string disagreement(Stepper& one, Stepper& other, std::span<const Motion> motions,
                         double accuracy);

}  // namespace keepout::app
