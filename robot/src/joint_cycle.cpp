// SPDX-License-Identifier: BSD-3-Clause
#include "joint_cycle.h"

#include <algorithm>
#include <cmath>

namespace keepout {
namespace {

constexpr int most_rounds = 16;
constexpr double least_asked = 1.0 / 16.0;  // of what is desired
constexpr double enough = 0.5;              // of a motion is made: nothing shorter is tried
constexpr double worthwhile = 1e-6;         // a share of the cost
constexpr int most_dampings = 3;            // of an attempt whose motions stray

}  // namespace

JointCycle::JointCycle(CycleMemory& memory, const InstrumentOptions& options,
                       std::span<const double> q, Meshes meshes) noexcept
    : memory_(memory),
      options_(options),
      box_(memory, options.period, q),
      watch_(memory, options, meshes == Meshes::moving && memory.is_moving()),
      guides_(memory, options),
      rows_(memory, watch_, guides_, options),
      meshes_move_(meshes == Meshes::moving && memory.is_moving()) {
  memory.motion.start(q);
  for (MeshMemory& mesh : memory.meshes) {
    Twist way;
    if (meshes_move_) {
      way = {.linear = options.period * mesh.velocity.linear,
             .angular = options.period * mesh.velocity.angular};
    }
    mesh.motion.start(mesh.pose, way);
  }
}

void JointCycle::run(const JointTask& task, InstrumentStep& result) noexcept {
  memory_.increment.fill(0.0);
  memory_.degraded.clear();
  guides_.open();
  result.guides = memory_.guide_states;
  result.status = watch_.open(result);
  if (box_.starts_outside()) result.limits.add(Limit::joints_outside);
  if (!is_ok(result.status)) {
    trouble_ = result.status;
    report_limits({}, result);
    return;
  }
  Trial best{.cost = task.standing * task.standing};
  rows_.start();
  if (meshes_move_) {
    search_beside_moving(task, best, result);
  } else {
    search(task, best, result);
  }
  if (owes_ || guides_.owes()) check_cut(best);
  result.degraded = memory_.degraded.view();
  watch_.close();
  if (is_ok(result.status) && result.status != Status::yielding && is_recovering())
    result.status = Status::recovering;
  if (result.status == Status::free && best.missed > 0.5 * task.standing) {
    result.status = Status::limited;
    best.held.add(Limit::singularity);
  }
  report_guides(best, result);
  report_limits(best, result);
  result.rounds = rounds_;
  result.rows = best.rows;
  result.triangles = in_reach_;
  if (is_ok(result.status)) carry_out(best, result);
}

/// If less than half of a motion can be proved, a shorter one bends less, and meets less. The rows
/// that were found stay.
void JointCycle::search(const JointTask& task, Trial& best, InstrumentStep& result) noexcept {
  double asked = 1.0;
  for (; asked >= least_asked; asked *= 0.25) {
    const bool goes_on = attempt(task, asked, best);
    if (best.share >= enough || !goes_on) break;
  }
  if (best.cell == 0) {
    result.status = trouble_ != Status::free ? trouble_ : Status::unsolved;
    // Guides that contradict each other leave a motion that is proved: to stand still.
    const bool is_search_over =
        result.status == Status::unsolved || result.status == Status::infeasible;
    if (is_search_over && stopped_.has(Limit::guide)) result.status = Status::fallback;
    rows_.remember_all();
  } else if (best.share < 1.0 || asked < 1.0) {
    result.status = Status::fallback;
  } else {
    result.status = best.held.empty() ? Status::free : Status::limited;
  }
}

/// For a share of what is asked for, with half of the work that is left. Whether another share may
/// fare better.
bool JointCycle::attempt(const JointTask& task, double asked, Trial& best) noexcept {
  trouble_ = Status::free;
  is_shortened_ = asked < 1.0;
  if (is_shortened_) rows_.forgive_curvature(0.0625);
  const bool is_spent = memory_.budget.halved([&] {
    JointTask part = task.scaled(asked);
    // A motion is shortened as it bends too much: damping takes most from the largest turns.
    if (is_shortened_ && !meshes_move_ && task.turn_weight) part = part.damped();
    for (int dampings = 0;; ++dampings) {
      has_strayed_ = false;
      if (seek(task, part, best)) {
        turn(task, part, best);
        if (dampings > 0) best.held.add(Limit::linearization);
      } else {
        note_failure();
      }
      const bool is_over =
          !has_strayed_ || dampings == most_dampings || is_worn_out() || trouble_ != Status::free;
      if (is_over) return is_worn_out();
      part = part.damped();
      rows_.forgive_curvature(0.0625);
    }
  });
  if (is_spent && trouble_ == Status::free) trouble_ = Status::out_of_budget;
  if (trouble_ == Status::over_capacity) stopped_.add(Limit::capacity);
  if (trouble_ == Status::out_of_budget) stopped_.add(Limit::budget);
  return trouble_ == Status::free || trouble_ == Status::over_capacity ||
         trouble_ == Status::out_of_budget;
}

/// Judges the part of a motion that is made as a motion of its own, as its end must make up for
/// what rounding took. If that fails, there is no motion.
void JointCycle::check_cut(Trial& best) noexcept {
  if (!(best.share > 0.0 && best.share < 1.0)) return;
  Trial cut;
  for (std::size_t k = 0; k < cut.increment.size(); ++k) {
    cut.increment[k] = best.share * best.increment[k];
  }
  judge(cut);
  if (cut.cell == PointMotion::cells) return;
  best.share = 0.0;
  best.increment.fill(0.0);
}

void JointCycle::carry_out(const Trial& best, InstrumentStep& result) noexcept {
  result.share = best.share;
  const auto n = static_cast<std::size_t>(memory_.instrument.chain().size());
  for (std::size_t k = 0; k < n; ++k) memory_.increment[k] = best.share * best.increment[k] + 0.0;
  box_.clip(memory_.increment);
  result.increment = {memory_.increment.data(), n};
  // The last motion judged need not be the best one.
  if (memory_.motion.increment() != memory_.increment) {
    memory_.motion.move(memory_.increment, options_.certified);
  }
  for (MeshMemory& mesh : memory_.meshes) {
    const Vec3* ended = mesh.motion.at(PointMotion::cells);
    std::copy(ended, ended + memory_.instrument.points().size(), mesh.ended_at.begin());
    mesh.side_of = options_.check_sides ? mesh.near->mesh().id() : 0;
  }
}

double JointCycle::prove(const JointVector& increment, InstrumentStep& result) noexcept {
  guides_.open();
  result.status = watch_.open(result);
  if (!is_ok(result.status)) return 0.0;
  memory_.rows.clear();
  Trial trial{.increment = increment};
  judge(trial);
  if (is_recovering()) result.status = Status::recovering;
  if (trouble_ != Status::free) result.status = trouble_;
  if (is_worn_out() && is_ok(result.status)) result.status = Status::out_of_budget;
  return is_ok(result.status) ? static_cast<double>(trial.cell) / PointMotion::cells : 0.0;
}

/// Solves and judges until a motion is certified; else `best` is the best part of those tried, if
/// any is better than standing still, or than what is best already. `part`: the task that is solved
/// for; motions are compared by `task`.
bool JointCycle::seek(const JointTask& task, const JointTask& part, Trial& best) noexcept {
  const bool was_found = best.cell > 0;
  const double cost_before = best.cost;
  for (int round = 0; round < most_rounds; ++round) {
    Trial trial;
    const SolveStatus solved = solve(part, trial);
    if (solved != SolveStatus::optimal) {
      if (solved == SolveStatus::ill_posed) trouble_ = Status::ill_posed;
      if (solved == SolveStatus::infeasible) trouble_ = Status::infeasible;
      return false;
    }
    ++rounds_;
    judge(trial);
    // All that is proven; but what costs more than standing still, and than coming back to the
    // margin within the band, only as far as it pays.
    trial.share = static_cast<double>(trial.cell) / PointMotion::cells;
    trial.cost = task.cost_of_share(trial.increment, trial.share);
    const double affordable = task.standing + 2.0 * options_.band;
    if (!is_recovering() && !meshes_move_ && trial.cost > affordable * affordable) {
      // Guides that are within their bands are pulled back only where the task does not pay for it.
      if (relax_guides()) continue;
      trial.share = task.best_share(trial.increment, trial.share);
      trial.held.add(Limit::linearization);
      trial.cost = task.cost_of_share(trial.increment, trial.share);
    }
    if (trial.share > 0.0 && part.standing > 0.0 && strays(task, trial)) {
      if (relax_guides()) continue;
      has_strayed_ = true;
      stopped_.add(Limit::linearization);
      if (meshes_move_ && trial.cell == PointMotion::cells) return false;
      cut_to_best(task, trial);
    }
    if (trial.cell == PointMotion::cells && trial.share == 1.0) {
      if (was_found && !(trial.cost < cost_before)) return false;
      best = trial;
      return true;
    }
    const bool is_better = best.cell == 0 || trial.cost < best.cost;
    if (trial.cell > 0 && is_better && !meshes_move_) best = trial;
    if (trial.cell == PointMotion::cells) return false;
    if (is_worn_out() || trouble_ != Status::free) return false;
    if (!answer()) return false;
  }
  return false;
}

/// Whether anything was found to say to what the last trial was not certified for.
bool JointCycle::answer() noexcept {
  const bool is_new_plane =
      kept_by_guides_ < PointMotion::cells && rows_.answer(failed_guide_, kept_by_guides_);
  const bool is_new_row = rows_.answer();
  if (memory_.rows.overflowed()) trouble_ = Status::over_capacity;
  return (is_new_plane || is_new_row) && !memory_.rows.overflowed();
}

/// Turns the rows that hold a certified motion back to where its end is, while that makes a better
/// one.
void JointCycle::turn(const JointTask& task, const JointTask& part, Trial& best) noexcept {
  for (int refinement = 0; refinement < options_.refinements; ++refinement) {
    if (best.rows == 0 || is_worn_out()) return;
    rows_.put_aside();
    if (!rows_.turn()) return;
    Trial trial;
    bool is_better = solve(part, trial) == SolveStatus::optimal;
    if (is_better) {
      trial.share = 1.0;
      trial.cost = task.cost(trial.increment);
      is_better = part.cost(trial.increment) < part.cost(best.increment) * (1.0 - worthwhile);
    }
    if (is_better) {
      ++rounds_;
      judge(trial);
      is_better = trial.cell == PointMotion::cells && !strays(task, trial);
    }
    if (!is_better) {
      rows_.take_back();
      return;
    }
    best = trial;
  }
}

/// How much of a motion is certified, and of each pair what speaks against the rest.
void JointCycle::judge(Trial& trial) noexcept {
  memory_.motion.move(trial.increment, options_.certified);
  for (MeshMemory& mesh : memory_.meshes) mesh.motion.move();
  kept_by_guides_ = guides_.judge(failed_guide_);
  trial.cell = kept_by_guides_;
  if (trial.cell == 0) {
    // Nothing is proved, whatever the bodies do. A motion that guides reject at once may be long,
    // so judging the bodies would cost much work.
    for (PairMemory& pair : memory_.pairs) pair.failure = {};
    return;
  }
  for (std::size_t p = 0; p < memory_.pairs.size(); ++p) {
    if (!watch_.is_watched(p)) continue;
    if (const Status looked = judge_pair(p); !is_ok(looked)) {
      trial.cell = 0;
      trouble_ = looked;
      return;
    }
    trial.cell = std::min(trial.cell, memory_.pairs[p].failure.cell);
  }
}

/// Judges the motion at hand for one pair. Returns free, or what is missing to look at it.
Status JointCycle::judge_pair(std::size_t p) noexcept {
  Budget& budget = memory_.budget;
  PairMemory& pair = memory_.pairs[p];
  RelativeMotion& motion = memory_.meshes[pair.mesh].motion;
  pair.failure = {};
  pair.reach = motion.farthest(pair.body);
  const double needed = memory_.instrument.bodies()[pair.body].radius + watch_.kept(p) + pair.reach;
  if (const Status looked = watch_.look(p, needed); !is_ok(looked)) return looked;
  const std::span<NearTriangle> triangles = pair.near.nearer_than(needed, budget);
  if (triangles.empty()) return Status::free;
  in_reach_ = std::max(in_reach_, triangles.size());
  Certificate certificate(memory_.instrument, pair.body, motion, pair.near, watch_.kept(p),
                          memory_.tolerance, budget);
  for (const ContactRow& row : memory_.rows) {
    if (row.owner == p) certificate.try_first(row.normal);
  }
  pair.failure = certificate.judge(triangles, pair.reach);
  owes_ = owes_ || certificate.owes();
  return Status::free;
}

}  // namespace keepout
