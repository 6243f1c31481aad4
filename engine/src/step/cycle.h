// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "keepout/activation/activation_rule.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "keepout/step/solver.h"
#include "tip_memory.h"

namespace keepout {

/// One control cycle of a tip, in stages. Open: the rule finds the distance of the tip, and may add
/// planes (the certified rule adds none). Solve: the solver proposes a trial motion within the
/// planes and the half-spaces of guides, which this stage adds. Judge: the rule accepts the trial,
/// or adds a plane. Cut: if the search ends without an accepted trial, the rule judges a part of
/// the last trial. Refine: searches for a better motion. If the cycle fails, the motion is zero and
/// the status gives the cause.
///
/// Planes and solver merely propose; rule and guides judge. The rule's judgement holds only for a
/// trial that ends in the searched region, because triangles beyond it were not searched. So
/// solve_relaxing() clips each trial to the ball over the target, and solve_and_judge() rejects
/// trials beyond the motion sphere.
///
/// Each search gets half of the work budget that is left at its start.
class Cycle {
 public:
  /// Preconditions: rule and solver are prepared for the memory's capacity; the request is not
  /// refused; the guides of the memory are open. Spends from `budget`. Adds the time of each stage
  /// to `times`, unless null.
  Cycle(ActivationRule& rule, Solver& solver, TipMemory& memory, Budget& budget,
        const StepOptions& options, const Motion& request, StageTimes* times) noexcept;

  /// Returns the step, whose views refer to the memory. Precondition: the first call. Does not
  /// allocate or throw.
  Step run() noexcept;

 private:
  using Verdict = Judgement::Verdict;

  /// A motion that the rule has not judged yet, or the cause why the solver found none.
  struct Trial {
    std::optional<Vec3> motion = std::nullopt;  // of the tip [length]
    Solution solution = {};                     // of `motion`; valid until the next solve
    Status failure = Status::unsolved;          // if there is no motion
  };

  /// The last trial of a search that accepted none, and the fraction of it that may be free. cut()
  /// judges that part.
  struct LastTrial {
    Vec3 motion = Vec3::Zero();
    double free_fraction = 0.0;
    Solution solution = {};  // of `motion`; empty once the solver has solved again
  };

  /// The end of a search: the status of the step, and the motion that the rule accepted, or zero
  /// motion on failure.
  struct Outcome {
    Status status;
    Vec3 motion = Vec3::Zero();
  };

  Opening open_as_far_as_fits() noexcept;
  Opening open() noexcept;
  Outcome search_and_refine() noexcept;
  Outcome search() noexcept;
  std::optional<Outcome> solve_and_judge(LastTrial& last) noexcept;
  Trial solve() noexcept;
  Trial solve_relaxing() noexcept;
  Trial solve_once() noexcept;
  bool relax() noexcept;
  Outcome cut(const LastTrial& last) noexcept;
  Outcome refine(Outcome best) noexcept;
  Outcome branch(const Outcome& best) noexcept;
  void push_branch(const Outcome& best) noexcept;
  /// Returns true if a motion was accepted, and a better one is searched for.
  bool is_refining() const noexcept { return !input_.accepted.isZero(0.0); }
  bool is_worthwhile(const Vec3& motion, const Vec3& best) const noexcept;
  Limits note_unsatisfied() noexcept;
  bool may_stand_still() const noexcept;
  void report(Step& step) noexcept;
  void add_time(std::int64_t StageTimes::*stage) noexcept;

  ActivationRule& rule_;
  Solver& solver_;
  TipMemory& memory_;
  Budget& budget_;
  const StepOptions& options_;
  const Motion& request_;
  RuleInput input_;
  EndRegion end_region_;              // where the solved motions may end
  int target_halvings_ = 0;           // in both openings of a recovery together
  Status halved_for_ = Status::free;  // over_capacity or out_of_budget, if the target was halved
  Relaxation relaxation_ = Relaxation::none;
  Limits limits_;  // of the present search, apart from active rows

  StageTimes* times_;
  std::chrono::steady_clock::time_point stage_began_;
};

/// Adds the limit that is the cause of a failure with this status, if there is one.
void add_limit_of(Status failure, Limits& limits) noexcept;

/// Returns the motion of the tip by a solved increment, dx = J u. Returns nothing if joints move so
/// far against each other that the rounding error exceeds `rounding`. [length]
std::optional<Vec3> tip_motion(const StepProblem& program, const Solution& solution,
                               double rounding) noexcept;

}  // namespace keepout
