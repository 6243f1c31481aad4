// SPDX-License-Identifier: BSD-3-Clause
#include "cycle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "input.h"

namespace keepout {
namespace {

// A sound rule needs few trials, and about a hundred at the tip of a cone. The limit bounds an
// unsound rule. The work budget, most_cutting_planes and Capacity::planes usually end a search
// first.
constexpr int most_rounds = 256;

constexpr int most_halvings = 8;

/// Returns the plane that bounds motions in the direction of `motion`, just short of `longest`.
HalfSpace bound_of(const Vec3& motion, double longest) noexcept {
  return {-motion / motion.norm(), -longest * (1.0 - 1e-9), no_triangle};
}

/// Returns true if every part of a motion that satisfies the caller's rows also satisfies them,
/// because no row demands a motion.
bool allow_parts(const std::optional<ExtraRows>& rows) noexcept {
  return !rows || std::all_of(rows->bounds(), rows->bounds() + rows->count(),
                              [](double bound) { return bound <= 0.0; });
}

}  // namespace

void add_limit_of(Status failure, Limits& limits) noexcept {
  if (failure == Status::out_of_budget) limits.add(Limit::budget);
  if (failure == Status::over_capacity) limits.add(Limit::capacity);
  if (failure == Status::inside || failure == Status::touching) limits.add(Limit::mesh);
}

Cycle::Cycle(ActivationRule& rule, Solver& solver, TipMemory& memory, Budget& budget,
             const StepOptions& options, const Motion& request, StageTimes* times) noexcept
    : rule_(rule),
      solver_(solver),
      memory_(memory),
      budget_(budget),
      options_(options),
      request_(request),
      input_(rule_input_of(request, options, rule.end_region())),
      end_region_(end_region_of(request, rule.end_region())),
      times_(times) {
  // Guides that pull back may demand more than the projection of the target.
  const bool leads_back = memory.guides.leads_back();
  if (leads_back) end_region_ = input_.searched_region = EndRegion::motion_sphere;
  // With joints, rows or damping the motion is no projection.
  input_.is_projected = !request.jacobian && !request.rows && options.damping == 0.0 &&
                        solver.ignores_idle_planes() && !leads_back;
  if (times_ != nullptr) stage_began_ = std::chrono::steady_clock::now();
}

Step Cycle::run() noexcept {
  Step step;
  // Not an input check, so that a tip inside is reported as inside whatever the capacity is.
  if (!memory_.has_room_for(request_)) {
    step.status = Status::over_capacity;
    return step;
  }
  // Halving the target helps only if it shrinks the region. It shrinks the ball over the target,
  // but not the motion sphere.
  Opening opening = end_region_ == EndRegion::target_ball ? open_as_far_as_fits() : open();
  step.distance = opening.distance;
  const bool recovering = opening.status == Status::recovering;
  if (recovering) {
    // The first opening finds the retreat. The second opening prepares the search with the retreat
    // as target, and its own retreat is not used. The planes of a retreat exclude standing still,
    // so the motion may end outside the ball over the target. It need not be much longer than the
    // target.
    input_.target = opening.target;
    end_region_ = input_.searched_region = EndRegion::motion_sphere;
    input_.longest = std::min(input_.longest, 2.0 * input_.target.norm());
    opening = open_as_far_as_fits();
  }
  Outcome found{opening.status};
  if (is_ok(opening.status)) {
    found = search_and_refine();
    add_time(&StageTimes::solve);
    step.planes = memory_.solver_planes();  // of a failure; report() replaces them on success
  }
  step.triangles = rule_.triangles();
  if (found.status == Status::infeasible || found.status == Status::unsolved) {
    const Limits constraints = note_unsatisfied();
    if (!may_stand_still()) {
      step.limits = constraints;
    } else {
      found = {Status::truncated};
      limits_.add(constraints);
      limits_.add(Limit::truncated);
      memory_.store_zero_result(request_, relaxation_, limits_);
    }
  }
  step.status = found.status;
  if (!is_ok(found.status)) return step;
  step.motion = without_signed_zeros(found.motion);
  step.increment = memory_.increment();
  report(step);
  // In a recovery the target is the retreat, not the desired increment.
  if (step.status == Status::free && request_.jacobian &&
      (input_.target - step.motion).squaredNorm() > 0.25 * input_.target.squaredNorm()) {
    step.status = Status::limited;
    step.limits.add(Limit::singularity);
  }
  if (target_halvings_ > 0) step.status = Status::truncated;
  if (recovering) step.status = Status::recovering;
  return step;
}

/// Opens the cycle, and halves the target until its triangles fit the capacity and the budget. Each
/// attempt gets half of the work budget that is left.
Opening Cycle::open_as_far_as_fits() noexcept {
  const auto open_with_half = [&] { return budget_.halved([&] { return open(); }); };
  Opening opening = open_with_half();
  const auto is_too_much = [&] {
    return opening.status == Status::over_capacity || opening.status == Status::out_of_budget;
  };
  while (is_too_much() && target_halvings_ < most_halvings) {
    halved_for_ = opening.status;
    // StepOptions::query may have widened the region.
    input_.searched_region = end_region_;
    input_.target *= 0.5;
    // The longest motion shrinks only in a recovery, where it is about twice the target (see run).
    if (end_region_ == EndRegion::motion_sphere) input_.longest *= 0.5;
    ++target_halvings_;
    opening = open_with_half();
  }
  return opening;
}

/// Lets the rule gather the triangles that matter for the target, or begin a traversal to them.
/// Then opens the cycle.
Opening Cycle::open() noexcept {
  memory_.planes.clear();
  const bool fits = rule_.gather(input_);
  add_time(&StageTimes::query);
  if (!fits) return {budget_.failure()};
  const Opening opening = rule_.open(input_, memory_.planes);
  add_time(&StageTimes::activation);
  return opening;
}

/// Finds a motion that the rule accepts, and improves it.
Cycle::Outcome Cycle::search_and_refine() noexcept {
  Outcome best = search();
  if (best.status != Status::limited) return best;
  best = refine(best);
  if (options_.nodes == 0) return best;
  const Outcome other = branch(best);
  return other.motion == best.motion ? best : refine(other);
}

/// Searches with half of the work budget. The rest is for cut(), which judges a part of the last
/// trial.
Cycle::Outcome Cycle::search() noexcept {
  limits_ = {};
  LastTrial last;
  const std::optional<Outcome> found = budget_.halved([&] { return solve_and_judge(last); });
  if (!found && is_refining()) return {Status::truncated};  // a part does not count
  return found ? *found : cut(last);
}

/// Solves again with the plane of each objection, until the rule accepts a trial or the solver
/// fails. Returns nothing if cut() must judge a part of the last trial.
std::optional<Cycle::Outcome> Cycle::solve_and_judge(LastTrial& last) noexcept {
  for (int round = 0; round < most_rounds; ++round) {
    const Trial trial = solve();
    last.solution = {};  // the solver has replaced it, and with joints a part of the trial needs it
    const bool has_earlier_part = last.free_fraction > 0.0 && !request_.jacobian;
    if (!trial.motion) {
      if (!has_earlier_part) return Outcome{trial.failure};
      add_limit_of(trial.failure, limits_);
      break;
    }
    const Vec3& motion = *trial.motion;
    // More planes only lead farther from the target, so this search finds no better motion. (If
    // planes would be relaxed or a trial clipped later, it might. That costs motion, not safety.)
    if (is_refining() && input_.is_projected && !is_worthwhile(motion, input_.accepted)) {
      return Outcome{Status::truncated};
    }
    // Triangles beyond the motion sphere were not searched. (In the ball over the target no trial
    // is that long: solve_relaxing() clips it.) The part of the trial before is dropped, although
    // cut() might accept it. That costs motion, not safety.
    if (motion.norm() > input_.longest) {
      memory_.planes.push(bound_of(motion, input_.longest));
      last.free_fraction = 0.0;
      continue;
    }
    // The guides had no further half-space that excludes the trial. The rule has not judged the
    // trial, so all of it may be free.
    if (!memory_.guides.allow(motion)) {
      last = {motion, 1.0, trial.solution};
      break;
    }
    const Judgement judgement = rule_.judge(input_, motion, memory_.planes);
    if (judgement.verdict == Verdict::accepted) {
      memory_.store_result(request_, motion, 1.0, trial.solution, relaxation_, {});
      return Outcome{trial.solution.active.empty() ? Status::free : Status::limited, motion};
    }
    if (budget_.is_spent()) add_limit_of(budget_.failure(), limits_);
    if (budget_.is_spent() && has_earlier_part) break;  // this trial was not judged
    last = {motion, judgement.free_fraction, trial.solution};
    if (judgement.verdict == Verdict::blocked) break;
  }
  return std::nullopt;
}

/// Returns the part of the last trial up to the first contact and within the guides' regions, if
/// the rule accepts that part. If the rule objects, its plane is reported with the failure.
Cycle::Outcome Cycle::cut(const LastTrial& last) noexcept {
  const double allowed = memory_.guides.allowed_fraction(last.motion);
  const double fraction = std::min(last.free_fraction * (1.0 - 1e-9), allowed);
  const Vec3 part = fraction * last.motion;
  if (!(fraction > 0.0) || !allow_parts(request_.rows) ||
      rule_.judge(input_, part, memory_.planes).verdict != Verdict::accepted) {
    if (limits_.has(Limit::capacity)) return {Status::over_capacity};
    return {limits_.has(Limit::budget) ? Status::out_of_budget : Status::unsolved};
  }
  limits_.add(Limit::truncated);
  if (last.free_fraction < 1.0) limits_.add(Limit::mesh);
  if (allowed < 1.0) limits_.add(Limit::guide);
  memory_.guides.note_left_by(last.motion);
  memory_.store_result(request_, part, fraction, last.solution, relaxation_, limits_);
  return {Status::truncated, part};
}

/// Returns the kinds of the constraints for which no motion was found. Marks their guides as
/// limiting the step.
Limits Cycle::note_unsatisfied() noexcept {
  Limits constraints;
  for (const HalfSpace& plane : memory_.planes) {
    constraints.add(plane.source == no_triangle ? Limit::radius : Limit::mesh);
  }
  if (!memory_.guides.planes().empty()) {
    constraints.add(Limit::guide);
    memory_.guides.note_all_active();
  }
  if (request_.rows) constraints.add(Limit::rows);
  return constraints;
}

/// Returns true if the constraints without a solution allow standing still: guides, and rows that
/// demand no motion. Without guides, only a retreat or rows can demand motions that contradict each
/// other. That failure is reported instead.
bool Cycle::may_stand_still() const noexcept {
  return !memory_.guides.planes().empty() && allow_parts(request_.rows);
}

/// Reports the constraints that limit the motion of the result.
void Cycle::report(Step& step) noexcept {
  step.planes = memory_.result_planes();
  step.active = memory_.active();
  step.relaxation = memory_.relaxation();
  step.limits = memory_.limits();
  if (target_halvings_ > 0) {
    step.limits.add(Limit::truncated);
    step.limits.add(halved_for_ == Status::over_capacity ? Limit::capacity : Limit::budget);
  }
  const std::size_t of_mesh = memory_.planes.size();  // the planes of guides follow
  for (const std::uint32_t row : step.active) {
    if (row < of_mesh) {
      step.limits.add(step.planes[row].source == no_triangle ? Limit::radius : Limit::mesh);
    } else if (row < step.planes.size()) {
      step.limits.add(Limit::guide);
      memory_.guides.note_active(row - of_mesh);
    } else {
      step.limits.add(Limit::rows);
    }
  }
}

void Cycle::add_time(std::int64_t StageTimes::*stage) noexcept {
  if (times_ == nullptr) return;
  const auto now = std::chrono::steady_clock::now();
  times_->*stage +=
      std::chrono::duration_cast<std::chrono::nanoseconds>(now - stage_began_).count();
  stage_began_ = now;
}

}  // namespace keepout
