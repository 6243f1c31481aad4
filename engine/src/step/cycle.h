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

/// One control cycle: the motion nearest to the one desired which the rule allows. The rule looks
/// around and opens with planes; then, in turn, the solver proposes a trial motion within the
/// planes, and the guides and the rule judge it and may add a plane, until none has an objection. A
/// better motion is then looked for while the options allow. On any trouble the motion is zero and
/// the status says why; no solver is taken at its word.
///
/// What it proposes trials with is not trusted: only the rule's judgement stands between a trial
/// and the robot.
class Cycle {
 public:
  /// Preconditions: rule and solver are prepared for the workspace's capacity; the motion is
  /// checked; the workspace's guides are open. Work is taken from the budget. What each stage takes
  /// is added to `times`, unless null.
  Cycle(ActivationRule& rule, Solver& solver, Workspace& work, Budget& budget,
        const StepOptions& options, const Motion& motion, StageTimes* times) noexcept;

  /// Fills a step that is empty so far. Its views are of the workspace. Allocates nothing, throws
  /// nothing.
  void run(Step& result) noexcept;

 private:
  /// A motion on trial, or why there is none: then it is zero.
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
  int halvings_ = 0;   // of the aim, until its region was small enough
  Status halved_for_;  // over_capacity or out_of_budget, if there are any
  Relaxation relaxation_ = Relaxation::none;
  Limits limits_;  // of the search at hand: those that are no active row

  StageTimes* times_;
  std::chrono::steady_clock::time_point last_;
};

/// What a solved increment does to the tip: dx = J u. Nothing when the joints would move so far,
/// one against the other, that more than `rounding` of it is lost in their digits.
std::optional<Vec3> tip_motion(const StepProblem& problem, const Solution& solution,
                               double rounding) noexcept;

}  // namespace keepout
