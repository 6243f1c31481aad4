// SPDX-License-Identifier: BSD-3-Clause
#include "cycle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "input.h"

namespace keepout {
namespace {

using Verdict = Judgement::Verdict;

// A sound rule needs few trials, and about a hundred at the tip of a cone. The limit bounds an
// unsound one; the work budget, most_cutting_planes and Capacity::planes usually end a search
// first.
constexpr int most_rounds = 256;

constexpr int most_halvings = 8;

/// The plane that bounds motions in one direction, just short of the longest.
HalfSpace bound_of(const Vec3& motion, double longest) noexcept {
  return {-motion / motion.norm(), -longest * (1.0 - 1e-9), no_triangle};
}

/// Returns true if every part of a motion that satisfies the caller's rows satisfies them too: no
/// row demands a motion.
bool allow_parts(const std::optional<ExtraRows>& rows) noexcept {
  return !rows || std::all_of(rows->bounds(), rows->bounds() + rows->count(),
                              [](double bound) { return bound <= 0.0; });
}

}  // namespace

Cycle::Cycle(ActivationRule& rule, Solver& solver, Workspace& work, Budget& budget,
             const StepOptions& options, const Motion& request, StageTimes* times) noexcept
    : rule_(rule),
      solver_(solver),
      work_(work),
      budget_(budget),
      options_(options),
      request_(request),
      problem_(cycle_problem_of(request, options, rule.end_region())),
      times_(times) {
  // Guides that pull back may demand more than the projection of the target.
  const bool leads_back = !work.guides.empty() && work.guides.leads_back();
  if (leads_back) problem_.end_region = problem_.searched_region = EndRegion::motion_sphere;
  // With joints, rows or damping the motion is no projection.
  problem_.is_projected = !request.jacobian && !request.rows && options.damping == 0.0 &&
                          solver.ignores_idle_planes() && !leads_back;
  if (times_ != nullptr) stage_began_ = std::chrono::steady_clock::now();
}

void Cycle::run(Step& result) noexcept {
  work_.planes.clear();
  if (!work_.has_room_for(request_)) {
    result.status = Status::over_capacity;
    return;
  }
  // Halving the target helps only if the region shrinks with it: the ball over the target does, the
  // motion sphere does not.
  Opening opening = problem_.end_region == EndRegion::target_ball ? open_as_far_as_fits() : open();
  result.distance = opening.distance;
  const bool recovering = opening.status == Status::recovering;
  if (recovering) {
    // The first opening finds the retreat; the second, by the same code, prepares the search with
    // the retreat as target, and the retreat that it returns is not used. The planes of a retreat
    // exclude standing still, so the motion may end outside the ball over the target; it need not
    // be much longer than the target.
    problem_.target = opening.target;
    problem_.end_region = problem_.searched_region = EndRegion::motion_sphere;
    problem_.longest = std::min(problem_.longest, 2.0 * problem_.target.norm());
    opening = open_as_far_as_fits();
  }
  Trial found{opening.status, Vec3::Zero()};
  if (is_ok(opening.status)) {
    found = search_and_refine();
    add_time(&StageTimes::solve);
    result.planes = work_.posed();
  }
  result.triangles = rule_.triangles();
  if (found.status == Status::infeasible || found.status == Status::unsolved) {
    const Limits constraints = unsatisfied();
    if (!may_stand_still()) {
      result.limits = constraints;
    } else {
      found = {Status::fallback, Vec3::Zero()};
      limits_.add(constraints);
      limits_.add(Limit::truncated);
      work_.store_zero_result(request_, relaxation_, limits_);
    }
  }
  result.status = found.status;
  if (!is_ok(found.status)) return;
  result.motion = without_signed_zeros(found.motion);
  result.increment = work_.increment();
  report(result);
  // In a recovery the target is the retreat, not the desired increment.
  if (result.status == Status::free && request_.jacobian &&
      (problem_.target - result.motion).squaredNorm() > 0.25 * problem_.target.squaredNorm()) {
    result.status = Status::limited;
    result.limits.add(Limit::singularity);
  }
  if (halvings_ > 0) result.status = Status::fallback;
  if (recovering) result.status = Status::recovering;
}

/// Returns true if standing still satisfies the constraints without a solution: guides, and rows
/// that demand no motion. Without guides the failure is reported instead.
bool Cycle::may_stand_still() const noexcept {
  return !work_.guides.planes().empty() && allow_parts(request_.rows);
}

/// Returns the kinds of the constraints for which no motion was found, and marks their guides as
/// limiting the step.
Limits Cycle::unsatisfied() noexcept {
  Limits constraints;
  for (const HalfSpace& plane : work_.planes) {
    constraints.add(plane.source == no_triangle ? Limit::radius : Limit::mesh);
  }
  if (!work_.guides.planes().empty()) {
    constraints.add(Limit::guide);
    work_.guides.note_all_active();
  }
  if (request_.rows) constraints.add(Limit::rows);
  return constraints;
}

/// Reports the constraints that limit the motion.
void Cycle::report(Step& result) noexcept {
  result.planes = work_.posed_for_result();
  result.active = work_.active();
  result.relaxation = work_.relaxation();
  result.limits = work_.limits();
  if (halvings_ > 0) {
    result.limits.add(Limit::truncated);
    result.limits.add(halved_for_ == Status::over_capacity ? Limit::capacity : Limit::budget);
  }
  const std::size_t of_mesh = work_.planes.size();
  for (const std::uint32_t row : result.active) {
    if (row < of_mesh) {
      const bool is_bound = work_.planes[row].source == no_triangle;
      result.limits.add(is_bound ? Limit::radius : Limit::mesh);
    } else if (row < result.planes.size()) {
      result.limits.add(Limit::guide);
      work_.guides.note_active(row - of_mesh);
    } else {
      result.limits.add(Limit::rows);
    }
  }
}

/// Has the rule gather the triangles that matter for the target, and open.
Opening Cycle::open() noexcept {
  work_.planes.clear();
  const bool fits = rule_.gather(problem_);
  add_time(&StageTimes::query);
  if (!fits) return {budget_.status_at_end()};
  const Opening opening = rule_.open(problem_, work_.planes);
  add_time(&StageTimes::activation);
  return opening;
}

/// Opens the cycle, each time with half of the work budget that is left. Halves the target until
/// its triangles fit the capacity and the budget.
Opening Cycle::open_as_far_as_fits() noexcept {
  const auto open_with_half = [&] { return budget_.halved([&] { return open(); }); };
  Opening opening = open_with_half();
  const auto is_too_much = [&] {
    return opening.status == Status::over_capacity || opening.status == Status::out_of_budget;
  };
  while (is_too_much() && halvings_ < most_halvings) {
    halved_for_ = opening.status;
    problem_.searched_region = problem_.end_region;
    problem_.target *= 0.5;
    if (problem_.end_region == EndRegion::motion_sphere) problem_.longest *= 0.5;
    ++halvings_;
    opening = open_with_half();
  }
  return opening;
}

/// Finds a motion that the rule accepts, and improves upon it.
Cycle::Trial Cycle::search_and_refine() noexcept {
  Trial best = search();
  if (best.status != Status::limited) return best;
  best = refine(best);
  if (options_.nodes == 0) return best;
  const Trial other = branch(best);
  return other.motion == best.motion ? best : refine(other);
}

/// Searches with half of the work budget. The rest is for a part of the last trial.
Cycle::Trial Cycle::search() noexcept {
  limits_ = {};
  LastTrial last;
  const std::optional<Trial> found = budget_.halved([&] { return solve_and_judge(last); });
  return found ? *found : cut(last);
}

/// Solves again with the plane of each objection, until the rule accepts a trial or the solver
/// fails. Returns nothing if a part of the last trial is to be judged instead.
std::optional<Cycle::Trial> Cycle::solve_and_judge(LastTrial& last) noexcept {
  for (int round = 0; round < most_rounds; ++round) {
    const Trial trial = solve();
    // With joints, this solution has replaced the increment of the last trial in work_.solution.
    const bool has_part = last.free_fraction > 0.0 && !request_.jacobian;
    if (!is_ok(trial.status)) {
      if (!has_part) return trial;
      add_cause(trial.status, limits_);
      work_.solution = {};
      break;
    }
    // No triangle was gathered beyond the sphere.
    if (trial.motion.norm() > problem_.longest) {
      work_.planes.push(bound_of(trial.motion, problem_.longest));
      last.free_fraction = 0.0;
      continue;
    }
    // No half-space was left that excludes it. The rule has not judged it: all of it may be free.
    if (!work_.guides.allow(trial.motion)) {
      last = {trial.motion, 1.0};
      break;
    }
    const Judgement judgement = rule_.judge(problem_, trial.motion, work_.planes);
    if (judgement.verdict == Verdict::accepted) {
      work_.store_result(request_, trial.motion, 1.0, relaxation_, {});
      return Trial{work_.solution.active.empty() ? Status::free : Status::limited, trial.motion};
    }
    if (budget_.is_spent()) add_cause(budget_.status_at_end(), limits_);
    if (budget_.is_spent() && has_part) {  // this trial was not judged
      work_.solution = {};
      break;
    }
    last = {trial.motion, judgement.free_fraction};
    if (judgement.verdict == Verdict::blocked) break;
  }
  return std::nullopt;
}

/// Returns the part of the last trial up to the first contact and within the guides' regions, if
/// the rule accepts it. If it objects, its plane is reported with the failure.
Cycle::Trial Cycle::cut(const LastTrial& last) noexcept {
  const double allowed = work_.guides.allowed_fraction(last.motion);
  const double fraction = std::min(last.free_fraction * (1.0 - 1e-9), allowed);
  const Vec3 part = fraction * last.motion;
  if (!(fraction > 0.0) || !allow_parts(request_.rows) ||
      rule_.judge(problem_, part, work_.planes).verdict != Verdict::accepted) {
    if (limits_.has(Limit::capacity)) return {Status::over_capacity, Vec3::Zero()};
    return {limits_.has(Limit::budget) ? Status::out_of_budget : Status::unsolved, Vec3::Zero()};
  }
  limits_.add(Limit::truncated);
  if (last.free_fraction < 1.0) limits_.add(Limit::mesh);
  if (allowed < 1.0) limits_.add(Limit::guide);
  work_.guides.note_left_by(last.motion);
  work_.store_result(request_, part, fraction, relaxation_, limits_);
  return {Status::fallback, part};
}

void Cycle::add_time(std::int64_t StageTimes::*stage) noexcept {
  if (times_ == nullptr) return;
  const auto now = std::chrono::steady_clock::now();
  times_->*stage +=
      std::chrono::duration_cast<std::chrono::nanoseconds>(now - stage_began_).count();
  stage_began_ = now;
}

}  // namespace keepout
