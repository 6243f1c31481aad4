// SPDX-License-Identifier: BSD-3-Clause
#include "joint_cycle.h"

#include <algorithm>

#include "flange_error.h"

namespace keepout {
namespace {

constexpr int most_rounds = 16;
constexpr double least_task = 1.0 / 16.0;   // the smallest fraction of the task that a search tries
constexpr double enough_of_a_motion = 0.5;  // if it is executed, no shorter task is tried
constexpr double least_improvement = 1e-6;  // of a refinement, as a fraction of the cost
constexpr int most_dampings = 3;            // of a search whose motions stray
constexpr double quarter_squared = 1.0 / 16;  // corrections are quadratic in the motion's length

}  // namespace

JointCycle::JointCycle(CycleMemory& memory, const InstrumentOptions& options,
                       std::span<const double> q, MeshMotion mesh_motion) noexcept
    : memory_(memory),
      cycle_{.options = options,
             .meshes_move = mesh_motion == MeshMotion::predicted && memory.is_moving()},
      box_(memory.instrument.chain(), memory.largest_length, options.period, q),
      pairs_(memory, cycle_),
      guides_(memory, cycle_),
      rows_(memory, pairs_, guides_, cycle_),
      problem_(memory, box_, pairs_, guides_) {
  memory.trial_motion.begin_cycle(q);
  for (MeshMemory& mesh : memory.meshes) {
    Twist displacement;
    if (cycle_.meshes_move) {
      displacement = {.linear = options.period * mesh.velocity.linear,
                      .angular = options.period * mesh.velocity.angular};
    }
    mesh.motion.begin_cycle(mesh.pose, displacement);
  }
}

InstrumentStep JointCycle::run(const JointTask& task) noexcept {
  memory_.increment.fill(0.0);
  const PairWatch::Opening opening = open();
  InstrumentStep result{.status = opening.status,
                        .distance = opening.distance,
                        .nearest = opening.body,
                        .nearest_mesh = opening.mesh,
                        .guides = guides_.states()};
  if (box_.starts_outside()) result.limits.add(Limit::joints_outside);
  Trial best;
  if (!is_ok(result.status)) {
    report_limits(best, true, result);
    return result;
  }
  best.cost = task.miss_at_rest * task.miss_at_rest;
  rows_.add_first_rows();
  Status& status = result.status;
  status = cycle_.meshes_move ? search_beside_moving(task, best) : search(task, best);
  cut(best);
  if (is_ok(status) && status != Status::degraded && is_recovering()) status = Status::recovering;
  if (status == Status::free && best.missed > 0.5 * task.miss_at_rest) {
    status = Status::limited;
    best.limits.add(Limit::singularity);
  }
  result.clearance_fraction = pairs_.list_degraded();
  result.degraded = pairs_.degraded();
  const bool is_cut = !is_ok(status) || is_shortened_ || best.fraction < 1.0;
  report_guides(best, is_cut, result);
  report_limits(best, is_cut, result);
  result.rounds = rounds_;
  result.rows = best.active_rows;
  result.triangles = pairs_.triangles_in_reach();
  if (is_ok(status)) carry_out(best, result);
  pairs_.remember_clearances();
  return result;
}

/// Measures guides and pairs as the cycle starts.
PairWatch::Opening JointCycle::open() noexcept {
  forget_obstacles();
  guides_.open();
  return pairs_.open();
}

/// Searches for the task. If less than half of a motion would be executed, searches for a quarter
/// of the task: a shorter motion has less curvature and meets fewer triangles. Rows stay. Returns
/// the outcome.
Status JointCycle::search(const JointTask& task, Trial& best) noexcept {
  double asked = 1.0;
  for (; asked >= least_task; asked *= 0.25) {
    const bool goes_on = search_fraction(task, asked, best);
    if (best.fraction >= enough_of_a_motion || !goes_on) break;
  }
  if (best.is_found()) return outcome(best, asked);
  rows_.remember_all();
  const Status status = search_status_ != Status::free ? search_status_ : Status::unsolved;
  // If a guide forbids every motion found, the search has not failed: the answer is zero motion,
  // which is proved beside meshes that stand still.
  const bool is_inconclusive = status == Status::unsolved || status == Status::infeasible;
  return is_inconclusive && stopping_limits_.has(Limit::guide) ? Status::truncated : status;
}

/// Returns the outcome of a search that found a motion. `asked`: the last fraction of the task that
/// was tried or would be next, below 1 if the whole task was not enough.
Status JointCycle::outcome(const Trial& best, double asked) noexcept {
  if (best.fraction < 1.0 || asked < 1.0) return Status::truncated;
  return best.limits.empty() ? Status::free : Status::limited;
}

/// Searches for a fraction of the task, with half of the work budget that is left. Returns true if
/// another fraction may succeed.
///
/// If a motion strays (measure_flange), solves again with more damping, and keeps the cheaper
/// motion in `best`. After a second attempt, `is_improved` is true only if that attempt improved on
/// the first.
bool JointCycle::search_fraction(const JointTask& task, double asked, Trial& best) noexcept {
  search_status_ = Status::free;
  is_shortened_ = asked < 1.0;
  if (is_shortened_) rows_.scale_corrections(quarter_squared);
  bool is_improved = false;
  const bool was_spent = memory_.budget.halved([&] {  // the half of the budget
    JointTask reduced = task.scaled(asked);
    // A shorter motion is needed because of curvature. Damping reduces the largest rotations most.
    if (is_shortened_ && !cycle_.meshes_move && task.is_of_flange()) reduced = reduced.damped();
    for (int dampings = 0;; ++dampings) {
      has_strayed_ = false;
      is_improved = solve_and_judge(task, reduced, best);
      if (!is_improved) note_failure();
      const Status ended = is_improved ? refine(task, reduced, best) : search_status_;
      if (is_improved && dampings > 0) best.limits.add(Limit::linearization);
      const bool is_over =
          !has_strayed_ || dampings == most_dampings || is_spent() || ended != Status::free;
      if (is_over) return is_spent();
      reduced = reduced.damped();
      // A guess: 16 times the damping shortens a motion to about a quarter.
      rows_.scale_corrections(quarter_squared);
    }
  });
  // If budget or capacity ends a refinement, the motion before it stays valid.
  if (is_improved) return true;
  if (was_spent && search_status_ == Status::free) search_status_ = Status::out_of_budget;
  note_end(search_status_);
  return search_status_ != Status::ill_posed && search_status_ != Status::infeasible;
}

/// Solves, judges and adds rows until all of a motion is proved. Returns true if `best` is now that
/// motion. Returns false also for a whole motion that is not cheaper than an earlier one. If false,
/// `best` is the cheapest motion or part proved so far; beside moving meshes it is unchanged.
/// `reduced`: the task that is solved for; motions are compared by `task`.
bool JointCycle::solve_and_judge(const JointTask& task, const JointTask& reduced,
                                 Trial& best) noexcept {
  const bool was_found = best.is_found();
  const double cost_before = best.cost;
  for (int round = 0; round < most_rounds; ++round) {
    Trial trial{problem_.solve(reduced, rows_.view())};
    if (trial.status != SolveStatus::optimal) {
      // If the solver did not converge, the search may go on with less of the task.
      if (trial.status == SolveStatus::ill_posed) search_status_ = Status::ill_posed;
      if (trial.status == SolveStatus::infeasible) search_status_ = Status::infeasible;
      return false;
    }
    rows_.remember(trial.active);
    ++rounds_;
    judgement_ = judge(trial.increment);
    search_status_ = judgement_.status;
    trial.knot = judgement_.knot;
    trial.fraction = trial.proved();
    trial.cost = task.cost_of_share(trial.increment, trial.fraction);
    // A motion may cost more than standing still if bodies and guides return within their bands.
    // Two bands are allowed for that (a length, also for a task of the joints). If it costs more,
    // only the fraction that costs least is executed.
    const double affordable = task.miss_at_rest + 2.0 * cycle_.options.band;
    if (!is_recovering() && !cycle_.meshes_move && trial.cost > affordable * affordable) {
      // Guides within their bands are pulled back only if that does not cost the task too much. If
      // they are relaxed, the same rows are solved again.
      if (problem_.relax_guides(rows_.view())) continue;
      trial.fraction = task.best_share(trial.increment, trial.fraction);
      trial.limits.add(Limit::linearization);
      trial.cost = task.cost_of_share(trial.increment, trial.fraction);
    }
    if (trial.fraction > 0.0 && reduced.miss_at_rest > 0.0 && measure_flange(task, trial)) {
      if (problem_.relax_guides(rows_.view())) continue;
      has_strayed_ = true;
      stopping_limits_.add(Limit::linearization);
      // Beside moving meshes no motion is truncated: only more damping helps.
      if (cycle_.meshes_move && trial.is_proved()) return false;
      trial = cut_for_flange(task, trial, memory_.trial_motion);
    }
    if (trial.is_proved() && trial.fraction == 1.0) {
      if (was_found && !(trial.cost < cost_before)) return false;
      best = trial;
      return true;
    }
    const bool is_better = !best.is_found() || trial.cost < best.cost;
    if (trial.is_found() && is_better && !cycle_.meshes_move) best = trial;
    if (trial.is_proved() || is_spent() || search_status_ != Status::free) return false;
    if (!add_rows()) return false;
  }
  return false;
}

/// Sets the motion to judge or to execute.
void JointCycle::set_trial(const JointVector& increment) noexcept {
  memory_.trial_motion.set_trial(increment, cycle_.options.certified);
  pairs_.update_bounds();
}

/// Proves as much of a motion as possible, and notes the obstacles. If the triangles near a pair
/// are not known, this pair is the only obstacle.
JointCycle::Judgement JointCycle::judge(const JointVector& increment) noexcept {
  set_trial(increment);
  forget_obstacles();
  Judgement found{.guide = guides_.judge()};
  found.knot = found.guide.knot;
  // A motion that guides reject at once may be long, so judging the bodies would cost much work.
  if (found.knot == 0) return found;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (!pairs_.is_watched(p)) continue;
    Certificate::Obstacle& obstacle = memory_.obstacles[p];
    const Status status = pairs_.judge(p, rows_.view(), obstacle);
    found.knot = std::min(found.knot, obstacle.knot);
    if (is_ok(status)) continue;
    forget_obstacles();
    obstacle.knot = 0;
    return {.knot = 0, .status = status};
  }
  return found;
}

void JointCycle::forget_obstacles() noexcept {
  std::fill(memory_.obstacles.begin(), memory_.obstacles.end(), Certificate::Obstacle{});
}

/// Sets trial.missed, the distance by which the true motion of the flange misses the task. Returns
/// true if the motion strays. Recoveries and joint tasks never stray.
bool JointCycle::measure_flange(const JointTask& task, Trial& trial) noexcept {
  const bool is_judged = task.is_of_flange() && !is_recovering() &&
                         cycle_.options.certified == CertifiedMotion::actual;
  if (!is_judged) return false;
  const FlangeError error =
      flange_error(task, trial, memory_.instrument.chain(), memory_.trial_motion);
  trial.missed = error.missed;
  return error.strays;
}

/// Adds rows for the obstacles to the last trial. Returns false if no row changed, or not all fit.
bool JointCycle::add_rows() noexcept {
  const bool is_by_guide =
      judgement_.guide.knot < PointMotion::last_knot && rows_.add(judgement_.guide);
  const bool is_by_body = rows_.add(memory_.obstacles);
  if (rows_.overflowed()) search_status_ = Status::over_capacity;
  return (is_by_guide || is_by_body) && !rows_.overflowed();
}

/// Re-linearizes the rows that limit a proved motion, at its end, as long as that gives a better
/// motion. Returns free, or the status if the triangles near the last trial are not known.
Status JointCycle::refine(const JointTask& task, const JointTask& reduced, Trial& best) noexcept {
  for (int refinement = 0; refinement < cycle_.options.refinements; ++refinement) {
    if (best.active_rows == 0 || is_spent() || !rows_.turn_planes_to_end()) break;
    Trial trial{problem_.solve(reduced, rows_.view())};
    trial.fraction = 1.0;
    trial.cost = task.cost(trial.increment);
    bool is_better =
        trial.status == SolveStatus::optimal &&
        reduced.cost(trial.increment) < reduced.cost(best.increment) * (1.0 - least_improvement);
    if (is_better) {
      ++rounds_;
      judgement_ = judge(trial.increment);
      trial.knot = judgement_.knot;
      is_better = trial.is_proved() && !measure_flange(task, trial);
    }
    if (!is_better) {
      rows_.turn_back();
      return judgement_.status;
    }
    rows_.remember(trial.active);
    best = trial;
  }
  return Status::free;
}

/// Truncates a motion to the fraction that is executed. With a deficit its end must gain clearance,
/// so the truncated motion is proved as a motion of its own. If the proof fails, the increment is
/// zero.
void JointCycle::cut(Trial& best) noexcept {
  if (best.fraction == 1.0) return;
  for (double& number : best.increment) number *= best.fraction;
  if (best.fraction == 0.0 || !(pairs_.owes() || guides_.owes())) return;
  const Judgement found = judge(best.increment);
  if (found.knot == PointMotion::last_knot) return;
  note_end(is_spent() ? Status::out_of_budget : found.status);
  best.fraction = 0.0;
  best.increment.fill(0.0);
}

/// Puts the motion into the result, and remembers its end.
void JointCycle::carry_out(const Trial& best, InstrumentStep& result) noexcept {
  result.fraction = best.fraction;
  const auto n = static_cast<std::size_t>(memory_.instrument.chain().size());
  JointVector& increment = memory_.increment;
  for (std::size_t k = 0; k < n; ++k) increment[k] = best.increment[k] + 0.0;  // turns -0 into 0
  box_.clip(increment);  // defence only: it changes nothing (docs/joint-space-step.md, Lemma 7)
  result.increment = {increment.data(), n};
  // The last motion judged, in this cycle or an earlier one, may be another one.
  if (memory_.trial_motion.increment() != increment) set_trial(increment);
  pairs_.remember_end();
}

MotionProof JointCycle::prove(const JointVector& increment) noexcept {
  const PairWatch::Opening opening = open();
  MotionProof proof{.status = opening.status, .distance = opening.distance};
  if (!is_ok(proof.status)) return proof;
  const Judgement found = judge(increment);
  if (is_recovering()) proof.status = Status::recovering;
  if (!is_ok(found.status)) proof.status = found.status;
  if (is_spent() && is_ok(proof.status)) proof.status = Status::out_of_budget;
  if (is_ok(proof.status)) {
    proof.fraction = static_cast<double>(found.knot) / PointMotion::last_knot;
  }
  return proof;
}

}  // namespace keepout
