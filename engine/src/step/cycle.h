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

/// One control cycle of a tip, in stages. Open: the rule finds how the tip stands, and may add
/// planes (the certified rule adds none). Solve: the solver proposes a trial motion within the
/// planes. Judge: the guides and the rule accept the trial or add a plane. Cut: if the search ends
/// without an accepted trial, a part of the last one is judged. Refine: searches for a better
/// motion. On failure the motion is zero and the status gives the cause.
///
/// Only the judgement of rule and guides is trusted. Planes and solver merely propose.
///
/// Each search gets half of the work budget that is left, so each refinement gets half of what the
/// search before it has left over.
class Cycle {
 public:
  /// Preconditions: rule and solver are prepared for the workspace's capacity; the request is not
  /// refused; the workspace's guides are open. Takes its work from the budget. Adds the time of
  /// each stage to `times`, unless null.
  Cycle(ActivationRule& rule, Solver& solver, Workspace& work, Budget& budget,
        const StepOptions& options, const Motion& request, StageTimes* times) noexcept;

  /// Fills an empty step. Its views are of the workspace. Allocates nothing, throws nothing.
  void run(Step& result) noexcept;

 private:
  /// A motion on trial, with status free or, once the rule has accepted it, as the step ends. If
  /// there is none, the motion is zero and the status gives the cause.
  struct Trial {
    Status status;
    Vec3 motion;
  };

  /// The last trial of a search that accepted none, and the fraction of it that may be free, as far
  /// as is known; `cut` judges that part.
  struct LastTrial {
    Vec3 motion = Vec3::Zero();
    double free_fraction = 0.0;
  };

  Opening open() noexcept;
  Opening open_as_far_as_fits() noexcept;
  Trial search_and_refine() noexcept;
  Trial search() noexcept;
  std::optional<Trial> solve_and_judge(LastTrial& last) noexcept;
  Trial cut(const LastTrial& last) noexcept;
  Trial solve() noexcept;
  Trial solve_relaxing() noexcept;
  Status solve_once(std::optional<Vec3>& motion) noexcept;
  bool relax() noexcept;
  bool may_stand_still() const noexcept;
  Limits unsatisfied() noexcept;
  void report(Step& result) noexcept;
  Trial refine(Trial best) noexcept;
  Trial branch(const Trial& best) noexcept;
  void push_branch(const Trial& best) noexcept;
  bool is_worthwhile(const Vec3& motion, const Vec3& best) const noexcept;
  void add_time(std::int64_t StageTimes::*stage) noexcept;

  ActivationRule& rule_;
  Solver& solver_;
  Workspace& work_;
  Budget& budget_;
  const StepOptions& options_;
  const Motion& request_;
  CycleProblem problem_;
  int halvings_ = 0;                  // of the target, until its triangles fit
  Status halved_for_ = Status::free;  // over_capacity or out_of_budget, if it was halved
  Relaxation relaxation_ = Relaxation::none;
  Limits limits_;  // of the search at hand, apart from active rows

  StageTimes* times_;
  std::chrono::steady_clock::time_point stage_began_;
};

/// Returns the motion of the tip by a solved increment, dx = J u; nothing if joints move so far
/// against each other that the rounding error exceeds `rounding`. [length]
std::optional<Vec3> tip_motion(const StepProblem& problem, const Solution& solution,
                               double rounding) noexcept;

}  // namespace keepout
