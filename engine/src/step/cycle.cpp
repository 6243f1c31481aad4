// SPDX-License-Identifier: BSD-3-Clause
#include "cycle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "input.h"

namespace keepout {
namespace {

using Verdict = Judgement::Verdict;

// A sound rule needs few rounds, and some hundred at the tip of a cone. The limit bounds an unsound
// one.
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
             const StepOptions& options, const Motion& motion, StageTimes* times) noexcept
    : rule_(rule),
      solver_(solver),
      work_(work),
      budget_(budget),
      options_(options),
      motion_(motion),
      problem_(cycle_problem_of(motion, options, rule.end_region())),
      times_(times) {
  // Guides that pull back may demand more than the projection of the target.
  const bool leads_back = !work.guides.empty() && work.guides.leads_back();
  if (leads_back) problem_.end_region = problem_.searched_region = EndRegion::motion_sphere;
  // With joints, rows or damping the motion is no projection.
  problem_.is_projected = !motion.jacobian && !motion.rows && options.damping == 0.0 &&
                          solver.reads_planes() && !leads_back;
  if (times_ != nullptr) last_ = std::chrono::steady_clock::now();
}

void Cycle::run(Step& result) noexcept {
  work_.planes.clear();
  if (!work_.has_room_for(motion_)) {
    result.status = Status::over_capacity;
    return;
  }
  // Halving the target helps only if the region shrinks with it.
  Opening opening = problem_.end_region == EndRegion::target_ball ? open_as_far_as_fits() : open();
  result.distance = opening.distance;
  const bool recovering = opening.status == Status::recovering;
  if (recovering) {
    // The retreat is the target now, so the rule opens again. The motion that retreats is no
    // projection of the target, and need not be much longer.
    problem_.target = opening.target;
    problem_.end_region = problem_.searched_region = EndRegion::motion_sphere;
    problem_.longest = std::min(problem_.longest, 2.0 * problem_.target.norm());
    opening = open_as_far_as_fits();
  }
  Trial found{opening.status, Vec3::Zero()};
  if (is_ok(opening.status)) {
    found = search_and_refine();
    ended(&StageTimes::solve);
    result.planes = work_.posed();
  }
  result.triangles = rule_.triangles();
  if (found.status == Status::infeasible || found.status == Status::unsolved) {
    const Limits constraints = unsatisfied();
    if (!constraints.has(Limit::guide) || !allow_parts(motion_.rows)) {
      result.limits = constraints;
    } else {
      // Standing still satisfies guides, and rows that require no motion.
      found = {Status::fallback, Vec3::Zero()};
      limits_.add(constraints);
      limits_.add(Limit::truncated);
      work_.store_zero_result(motion_, relaxation_, limits_);
    }
  }
  result.status = found.status;
  if (!is_ok(found.status)) return;
  // Number by number, as the increment: no zero has a sign.
  for (int axis = 0; axis < 3; ++axis) result.motion[axis] = found.motion[axis] + 0.0;
  result.increment = work_.increment();
  report(result);
  // In a recovery the target is the retreat, not the commanded motion.
  if (result.status == Status::free && motion_.jacobian &&
      (problem_.target - result.motion).squaredNorm() > 0.25 * problem_.target.squaredNorm()) {
    result.status = Status::limited;
    result.limits.add(Limit::singularity);
  }
  if (halvings_ > 0) result.status = Status::fallback;
  if (recovering) result.status = Status::recovering;
}

/// Returns the kinds of the constraints for which no motion was found, and notes their guides.
Limits Cycle::unsatisfied() noexcept {
  Limits constraints;
  for (const HalfSpace& plane : work_.planes) {
    constraints.add(plane.source == no_triangle ? Limit::radius : Limit::mesh);
  }
  if (!work_.guides.planes().empty()) {
    constraints.add(Limit::guide);
    work_.guides.note_all_active();
  }
  if (motion_.rows) constraints.add(Limit::rows);
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
  if (result.active.empty()) return;
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
  ended(&StageTimes::query);
  if (!fits) return {budget_.status_at_end()};
  const Opening opening = rule_.open(problem_, work_.planes);
  ended(&StageTimes::activation);
  return opening;
}

/// Opens the cycle. Halves the target until its triangles fit the capacity and the budget.
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
  Trial last{Status::unsolved, Vec3::Zero()};
  double free_fraction = 0.0;  // of the last trial
  const std::optional<Trial> found =
      budget_.halved([&] { return solve_and_judge(last, free_fraction); });
  return found ? *found : cut(last, free_fraction);
}

/// Solves again with the plane of each objection, until the rule accepts a trial. Otherwise returns
/// nothing; then `last` is the last trial that was judged, and `free_fraction` the part of it that
/// is free.
std::optional<Cycle::Trial> Cycle::solve_and_judge(Trial& last, double& free_fraction) noexcept {
  for (int round = 0; round < most_rounds; ++round) {
    const Trial trial = solve();
    // A part of the last trial may be executed. With joints its increment is lost.
    const bool has_part = free_fraction > 0.0 && !motion_.jacobian;
    if (!is_ok(trial.status)) {
      if (!has_part) return trial;
      note(trial.status);
      work_.solution = {};
      break;
    }
    // No triangle was gathered beyond the sphere.
    if (trial.motion.norm() > problem_.longest) {
      work_.planes.push(bound_of(trial.motion, problem_.longest));
      free_fraction = 0.0;
      continue;
    }
    // No half-space was left that excludes it.
    if (!work_.guides.allow(trial.motion)) {
      last = trial;
      free_fraction = 1.0;
      break;
    }
    const Judgement judgement = rule_.judge(problem_, trial.motion, work_.planes);
    if (judgement.verdict == Verdict::accepted) {
      work_.store_result(motion_, trial.motion, 1.0, relaxation_, {});
      return Trial{work_.solution.active.empty() ? trial.status : Status::limited, trial.motion};
    }
    if (budget_.is_spent()) note(budget_.status_at_end());
    if (budget_.is_spent() && has_part) {  // this trial was not judged
      work_.solution = {};
      break;
    }
    last = trial;
    free_fraction = judgement.free_fraction;
    if (judgement.verdict == Verdict::blocked) break;
  }
  return std::nullopt;
}

/// Returns the part of the last trial up to the first contact and within the guides' regions, if
/// the rule accepts it.
Cycle::Trial Cycle::cut(const Trial& trial, double free_fraction) noexcept {
  const double allowed = work_.guides.allowed_fraction(trial.motion);
  const double share = std::min(free_fraction * (1.0 - 1e-9), allowed);
  const Vec3 part = share * trial.motion;
  if (!(share > 0.0) || !allow_parts(motion_.rows) ||
      rule_.judge(problem_, part, work_.planes).verdict != Verdict::accepted) {
    if (limits_.has(Limit::capacity)) return {Status::over_capacity, Vec3::Zero()};
    return {limits_.has(Limit::budget) ? Status::out_of_budget : Status::unsolved, Vec3::Zero()};
  }
  limits_.add(Limit::truncated);
  if (free_fraction < 1.0) limits_.add(Limit::mesh);
  if (allowed < 1.0) limits_.add(Limit::guide);
  work_.guides.note_left_by(trial.motion);
  work_.store_result(motion_, part, share, relaxation_, limits_);
  return {Status::fallback, part};
}

/// Notes that capacity or budget ended the search.
void Cycle::note(Status ended) noexcept {
  if (ended == Status::out_of_budget) limits_.add(Limit::budget);
  if (ended == Status::over_capacity) limits_.add(Limit::capacity);
}

void Cycle::ended(std::int64_t StageTimes::*stage) noexcept {
  if (times_ == nullptr) return;
  const auto now = std::chrono::steady_clock::now();
  times_->*stage += std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_).count();
  last_ = now;
}

}  // namespace keepout
