// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "keepout/activation/activation_rule.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "keepout/step/solver.h"
#include "workspace.h"

namespace keepout {

/// One control cycle of a tip: open, then solve and judge until a motion is accepted, or cut the
/// last trial to the part that is; then refine. The rule opens with planes. The solver proposes a
/// trial motion within the planes; the guides and the rule judge it and may add a plane. On failure
/// the motion is zero and the status gives the cause.
///
/// Only the judgement of rule and guides is trusted. Planes and solver merely propose.
class Cycle {
 public:
  /// Preconditions: rule and solver are prepared for the workspace's capacity; the motion is
  /// checked; the workspace's guides are open. Takes its work from the budget. Adds the time of
  /// each stage to `times`, unless null.
  Cycle(ActivationRule& rule, Solver& solver, Workspace& work, Budget& budget,
        const StepOptions& options, const Motion& motion, StageTimes* times) noexcept;

  /// Fills an empty step. Its views are of the workspace. Allocates nothing, throws nothing.
  void run(Step& result) noexcept;

 private:
  /// A motion on trial. If there is none, it is zero and the status gives the cause.
  struct Trial {
    Status status;
    Vec3 motion;
  };

  Opening open() noexcept;
  Opening open_as_far_as_fits() noexcept;
  Trial search_and_refine() noexcept;
  Trial search() noexcept;
  std::optional<Trial> solve_and_judge(Trial& last, double& free_fraction) noexcept;
  Trial cut(const Trial& trial, double free_fraction) noexcept;
  Trial solve() noexcept;
  Trial solve_relaxing() noexcept;
  Status solve_once(std::optional<Vec3>& motion) noexcept;
  bool relax() noexcept;
  void note(Status ended) noexcept;
  Limits unsatisfied() noexcept;
  void report(Step& result) noexcept;
  Trial refine(Trial best) noexcept;
  Trial branch(const Trial& best) noexcept;
  void open_branch(const Trial& best) noexcept;
  bool is_worthwhile(const Vec3& motion, const Vec3& best) const noexcept;
  void ended(std::int64_t StageTimes::*stage) noexcept;

  ActivationRule& rule_;
  Solver& solver_;
  Workspace& work_;
  Budget& budget_;
  const StepOptions& options_;
  const Motion& motion_;
  CycleProblem problem_;
  int halvings_ = 0;   // of the target, until its triangles fit
  Status halved_for_;  // over_capacity or out_of_budget, if there are any
  Relaxation relaxation_ = Relaxation::none;
  Limits limits_;  // of the search at hand, apart from active rows

  StageTimes* times_;
  std::chrono::steady_clock::time_point last_;
};

/// Returns the motion of the tip by a solved increment, dx = J u; nothing if joints move so far
/// against each other that the rounding error exceeds `rounding`. [length]
std::optional<Vec3> tip_motion(const StepProblem& problem, const Solution& solution,
                               double rounding) noexcept;

}  // namespace keepout
