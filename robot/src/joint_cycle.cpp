// SPDX-License-Identifier: BSD-3-Clause
#include "joint_cycle.h"

#include <algorithm>
#include <cmath>

#include "flange_error.h"

namespace keepout {
namespace {

constexpr int most_rounds = 16;
constexpr double least_task = 1.0 / 16.0;     // the smallest fraction that is searched for
constexpr double enough_of_a_motion = 0.5;    // if it is executed, no shorter task is tried
constexpr double least_improvement = 1e-6;    // by a refinement, a fraction of the cost
constexpr int most_dampings = 3;              // of a search whose motions stray
constexpr double quarter_squared = 1.0 / 16;  // curvature is quadratic in the length of a motion

}  // namespace

JointCycle::JointCycle(CycleMemory& memory, const InstrumentOptions& options,
                       std::span<const double> q, Meshes meshes) noexcept
    : memory_(memory),
      context_{.instrument = memory.instrument,
               .options = options,
               .tolerance = memory.tolerance,
               .meshes_move = meshes == Meshes::moving && memory.is_moving(),
               .motion = memory.motion,
               .budget = memory.budget},
      box_(memory.instrument.chain(), memory.largest_position, options.period, q),
      bodies_(memory.bodies, context_),
      guides_(memory.guides, context_),
      rows_(memory.rows, bodies_, guides_, context_),
      problem_(memory.problem, box_, bodies_, guides_, context_) {
  memory.motion.start(q);
  for (MeshMemory& mesh : memory.bodies.meshes) {
    Twist displacement;
    if (context_.meshes_move) {
      displacement = {.linear = options.period * mesh.velocity.linear,
                      .angular = options.period * mesh.velocity.angular};
    }
    mesh.motion.start(mesh.pose, displacement);
  }
}

void JointCycle::run(const JointTask& task, InstrumentStep& result) noexcept {
  memory_.increment.fill(0.0);
  open(result);
  result.guides = guides_.states();
  if (box_.starts_outside()) result.limits.add(Limit::joints_outside);
  if (!is_ok(result.status)) {
    search_status_ = result.status;
    report_limits({}, result);
    return;
  }
  Trial best{.cost = task.standing * task.standing};
  rows_.start();
  if (context_.meshes_move) {
    search_beside_moving(task, best, result);
  } else {
    search(task, best, result);
  }
  cut(best);
  result.degraded = bodies_.degraded();
  bodies_.close();
  if (is_ok(result.status) && result.status != Status::yielding && is_recovering())
    result.status = Status::recovering;
  if (result.status == Status::free && best.missed > 0.5 * task.standing) {
    result.status = Status::limited;
    best.limits.add(Limit::singularity);
  }
  report_guides(best, result);
  report_limits(best, result);
  result.rounds = rounds_;
  result.rows = best.rows;
  result.triangles = bodies_.triangles_in_reach();
  if (is_ok(result.status)) carry_out(best, result);
}

/// Measures guides and bodies as the cycle starts.
void JointCycle::open(InstrumentStep& result) noexcept {
  forget_obstacles();
  guides_.open();
  bodies_.open(result);
}

/// Searches for the task. If less than half of a motion would be executed, searches for a quarter
/// of the task: a shorter motion bends less and meets less. The rows that were found stay.
void JointCycle::search(const JointTask& task, Trial& best, InstrumentStep& result) noexcept {
  double asked = 1.0;
  for (; asked >= least_task; asked *= 0.25) {
    const bool goes_on = search_fraction(task, asked, best);
    if (best.fraction >= enough_of_a_motion || !goes_on) break;
  }
  if (best.knot == 0) {
    result.status = search_status_ != Status::free ? search_status_ : Status::unsolved;
    // If a guide ended a search, zero motion is returned: it is proved beside meshes that stand
    // still.
    const bool is_search_over =
        result.status == Status::unsolved || result.status == Status::infeasible;
    if (is_search_over && stopping_limits_.has(Limit::guide)) result.status = Status::fallback;
    rows_.remember_all();
  } else if (best.fraction < 1.0 || asked < 1.0) {
    result.status = Status::fallback;
  } else {
    result.status = best.limits.empty() ? Status::free : Status::limited;
  }
}

/// Searches for a fraction of the task, with half of the work budget that is left. Returns true if
/// another fraction may succeed.
bool JointCycle::search_fraction(const JointTask& task, double asked, Trial& best) noexcept {
  search_status_ = Status::free;
  is_shortened_ = asked < 1.0;
  if (is_shortened_) rows_.forgive_curvature(quarter_squared);
  const bool was_spent = context_.budget.halved([&] {
    JointTask part = task.scaled(asked);
    // A motion is shortened because it bends too much. Damping reduces the largest rotations most.
    if (is_shortened_ && !context_.meshes_move && task.is_of_flange()) part = part.damped();
    for (int dampings = 0;; ++dampings) {
      has_strayed_ = false;
      if (solve_and_judge(task, part, best)) {
        refine(task, part, best);
        if (dampings > 0) best.limits.add(Limit::linearization);
      } else {
        note_failure();
      }
      const bool is_over = !has_strayed_ || dampings == most_dampings || is_spent() ||
                           search_status_ != Status::free;
      if (is_over) return is_spent();
      part = part.damped();
      rows_.forgive_curvature(quarter_squared);
    }
  });
  if (was_spent && search_status_ == Status::free) search_status_ = Status::out_of_budget;
  if (search_status_ == Status::over_capacity) stopping_limits_.add(Limit::capacity);
  if (search_status_ == Status::out_of_budget) stopping_limits_.add(Limit::budget);
  return search_status_ == Status::free || search_status_ == Status::over_capacity ||
         search_status_ == Status::out_of_budget;
}

/// Cuts a motion to the fraction that is executed. If rounding has left less than some clearance,
/// the end of that part must make up for it, so it is proved as a motion of its own. If the proof
/// fails, there is no motion.
void JointCycle::cut(Trial& best) noexcept {
  if (best.fraction == 1.0) return;
  for (double& number : best.increment) number *= best.fraction;
  if (best.fraction == 0.0 || !(bodies_.owes() || guides_.owes())) return;
  Trial part{.increment = best.increment};
  judge(part);
  if (part.is_proved()) return;
  best.fraction = 0.0;
  best.increment.fill(0.0);
}

void JointCycle::carry_out(const Trial& best, InstrumentStep& result) noexcept {
  result.share = best.fraction;
  const auto n = static_cast<std::size_t>(context_.instrument.chain().size());
  JointVector& increment = memory_.increment;
  // The sum turns -0 into 0. Clipping changes nothing (docs/joint-space-step.md, Lemma 7).
  for (std::size_t k = 0; k < n; ++k) increment[k] = best.increment[k] + 0.0;
  box_.clip(increment);
  result.increment = {increment.data(), n};
  // The last motion judged may be another one.
  if (context_.motion.increment() != increment) try_motion(increment);
  bodies_.remember_end();
}

double JointCycle::prove(const JointVector& increment, InstrumentStep& result) noexcept {
  open(result);
  if (!is_ok(result.status)) return 0.0;
  rows_.clear();
  Trial trial{.increment = increment};
  judge(trial);
  if (is_recovering()) result.status = Status::recovering;
  if (search_status_ != Status::free) result.status = search_status_;
  if (is_spent() && is_ok(result.status)) result.status = Status::out_of_budget;
  return is_ok(result.status) ? trial.proved() : 0.0;
}

/// Solves, judges and adds rows until all of a motion is proved: then `best` is that motion, and
/// true is returned if it may be refined. Otherwise `best` becomes the proved part of a trial that
/// costs least, if it costs less than `best`, or if nothing was proved so far. `part`: the task
/// that is solved for; motions are compared by `task`.
bool JointCycle::solve_and_judge(const JointTask& task, const JointTask& part,
                                 Trial& best) noexcept {
  const bool was_found = best.knot > 0;
  const double cost_before = best.cost;
  for (int round = 0; round < most_rounds; ++round) {
    Trial trial;
    const SolveStatus solved = solve(part, trial);
    if (solved != SolveStatus::optimal) {
      if (solved == SolveStatus::ill_posed) search_status_ = Status::ill_posed;
      if (solved == SolveStatus::infeasible) search_status_ = Status::infeasible;
      return false;
    }
    ++rounds_;
    judge(trial);
    // All that is proved is executed, unless it costs more than zero motion and a return to margins
    // and regions within their bands: then the fraction that costs least.
    trial.fraction = trial.proved();
    trial.cost = task.cost_of_share(trial.increment, trial.fraction);
    const double affordable = task.standing + 2.0 * context_.options.band;
    if (!is_recovering() && !context_.meshes_move && trial.cost > affordable * affordable) {
      // Guides within their bands are pulled back only if that does not cost the task too much. If
      // they are relaxed, the same rows are solved again.
      if (problem_.relax_guides(rows_.view())) continue;
      trial.fraction = task.best_share(trial.increment, trial.fraction);
      trial.limits.add(Limit::linearization);
      trial.cost = task.cost_of_share(trial.increment, trial.fraction);
    }
    if (trial.fraction > 0.0 && part.standing > 0.0 && strays(task, trial)) {
      if (problem_.relax_guides(rows_.view())) continue;
      has_strayed_ = true;
      stopping_limits_.add(Limit::linearization);
      if (context_.meshes_move && trial.is_proved()) return false;
      trial = cut_for_flange(task, trial, context_.motion);
    }
    if (trial.is_proved() && trial.fraction == 1.0) {
      if (was_found && !(trial.cost < cost_before)) return false;
      best = trial;
      return true;
    }
    const bool is_better = best.knot == 0 || trial.cost < best.cost;
    if (trial.knot > 0 && is_better && !context_.meshes_move) best = trial;
    if (trial.is_proved() || is_spent() || search_status_ != Status::free) return false;
    if (!add_rows()) return false;
  }
  return false;
}

/// Solves for a task. Returns the status of the solver.
SolveStatus JointCycle::solve(const JointTask& task, Trial& trial) noexcept {
  const Proposal proposal = problem_.solve(task, rows_.view());
  trial.relaxation = proposal.relaxation;
  if (proposal.status != SolveStatus::optimal) return proposal.status;
  trial.increment = proposal.increment;
  trial.limits = proposal.limits;
  trial.guides = proposal.guides;
  trial.rows = rows_.remember(proposal.active);
  return proposal.status;
}

/// Proves as much of a trial motion as possible, and notes the obstacles. If the triangles near a
/// pair are not known, nothing is proved, and this pair is the only obstacle.
void JointCycle::judge(Trial& trial) noexcept {
  try_motion(trial.increment);
  forget_obstacles();
  guide_obstacle_ = guides_.judge();
  trial.knot = guide_obstacle_.knot;
  // A motion that guides reject at once may be long, so judging the bodies would cost much work.
  if (trial.knot == 0) return;
  for (std::size_t p = 0; p < bodies_.size(); ++p) {
    if (!bodies_.is_watched(p)) continue;
    Certificate::Obstacle& obstacle = memory_.obstacles[p];
    const Status status = bodies_.judge(p, rows_.view(), obstacle);
    trial.knot = std::min(trial.knot, obstacle.knot);
    if (is_ok(status)) continue;
    search_status_ = status;
    guide_obstacle_ = {};
    forget_obstacles();
    obstacle.knot = 0;
    return;
  }
}

void JointCycle::forget_obstacles() noexcept {
  std::fill(memory_.obstacles.begin(), memory_.obstacles.end(), Certificate::Obstacle{});
}

/// Starts the proof of a motion.
void JointCycle::try_motion(const JointVector& increment) noexcept {
  context_.motion.move(increment, context_.options.certified);
  bodies_.move();
}

/// Sets what the true motion of the flange misses of the task. Returns true if it strays from the
/// task; recoveries and joint tasks never do.
bool JointCycle::strays(const JointTask& task, Trial& trial) noexcept {
  const bool is_judged = task.is_of_flange() && !is_recovering() &&
                         context_.options.certified == CertifiedMotion::actual;
  if (!is_judged) return false;
  const FlangeError error = flange_error(task, trial, context_.instrument.chain(), context_.motion);
  trial.missed = error.missed;
  return error.strays;
}

/// Adds rows for the obstacles to the last trial. Returns false if no row changed, or not all fit.
bool JointCycle::add_rows() noexcept {
  const bool is_by_guide =
      guide_obstacle_.knot < PointMotion::last_knot && rows_.add(guide_obstacle_);
  const bool is_by_body = rows_.add(memory_.obstacles);
  if (rows_.overflowed()) search_status_ = Status::over_capacity;
  return (is_by_guide || is_by_body) && !rows_.overflowed();
}

/// Turns the planes of the rows that limit a proved motion to its end, while that makes a better
/// motion.
void JointCycle::refine(const JointTask& task, const JointTask& part, Trial& best) noexcept {
  for (int refinement = 0; refinement < context_.options.refinements; ++refinement) {
    if (best.rows == 0 || is_spent()) return;
    rows_.save();
    if (!rows_.relinearize()) return;
    Trial trial;
    bool is_better = solve(part, trial) == SolveStatus::optimal;
    if (is_better) {
      trial.fraction = 1.0;
      trial.cost = task.cost(trial.increment);
      is_better =
          part.cost(trial.increment) < part.cost(best.increment) * (1.0 - least_improvement);
    }
    if (is_better) {
      ++rounds_;
      judge(trial);
      is_better = trial.is_proved() && !strays(task, trial);
    }
    if (!is_better) {
      rows_.restore();
      return;
    }
    best = trial;
  }
}

}  // namespace keepout
