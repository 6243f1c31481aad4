// SPDX-License-Identifier: BSD-3-Clause
//
// The quadratic problem of a joint cycle: its bounds, their relaxation, and its solution.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "joint_cycle.h"

namespace keepout {
namespace {

// Constraints that pull back are relaxed in this order: guides first. The last entry allows zero
// motion.
constexpr Softness relaxations[] = {
    {Relaxation::none, 1.0, true, 1.0},      {Relaxation::guides, 0.5, true, 1.0},
    {Relaxation::guides, 0.5, false, 1.0},   {Relaxation::guides, 0.0, false, 1.0},
    {Relaxation::recovery, 0.0, false, 0.5}, {Relaxation::recovery, 0.0, false, 0.25},
    {Relaxation::recovery, 0.0, false, 0.0}};
constexpr std::size_t holding = 2;
constexpr std::size_t all_of_the_band = 3;

}  // namespace

/// Solves for a task. Relaxes constraints that pull back if they contradict each other, or if the
/// solver does not converge.
SolveStatus JointCycle::solve(const JointTask& task, Trial& trial) noexcept {
  Solution solution;
  bool guides_lead = false;
  bool bodies_lead = false;
  for (const ContactRow& row : memory_.rows) {
    bool& lead = row.owner < most_pairs ? bodies_lead : guides_lead;
    lead = lead || row.bound > 0.0;
  }
  SolveStatus solved = SolveStatus::infeasible;
  for (std::size_t i = 0; i < std::size(relaxations); ++i) {
    const Softness& softness = relaxations[i];
    if (softness.name == Relaxation::guides && !guides_lead) continue;
    if (guides_lead && i < relaxed_) continue;
    solved = pose(task, softness, solution);
    trial.relaxation = softness.name;
    if (softness.name == Relaxation::recovery && !bodies_lead) {
      trial.relaxation = guides_lead ? Relaxation::guides : Relaxation::none;
    }
    if (i < all_of_the_band && solved == SolveStatus::optimal && guides_lead &&
        is_far_fetched(task, softness, relaxations[all_of_the_band], solution)) {
      relaxed_ = std::max(relaxed_, i + 1);
      continue;
    }
    if (solved == SolveStatus::optimal || solved == SolveStatus::ill_posed) break;
  }
  if (solved != SolveStatus::optimal) return solved;
  const auto n = static_cast<std::size_t>(task.joints);
  trial.increment.fill(0.0);
  for (std::size_t k = 0; k < n; ++k) {
    if (!std::isfinite(solution.u[k])) return SolveStatus::iteration_limit;
    trial.increment[k] = task.unit[k] * solution.u[k];
  }
  note_held(solution, trial);
  if (box_.clip(trial.increment)) trial.held.add(Limit::joint_position);
  trial.rows = rows_.hold(solution.active);
  return solved;
}

/// Stops pulling guides back into their regions, by the least relaxation that is left. Returns
/// false if no guide is pulled back, or if no relaxation is left.
bool JointCycle::relax_guides() noexcept {
  const bool is_any_pulled =
      std::any_of(memory_.rows.begin(), memory_.rows.end(),
                  [](const ContactRow& row) { return row.owner >= most_pairs && row.bound > 0.0; });
  if (!is_any_pulled || relaxed_ >= holding) return false;
  ++relaxed_;
  return true;
}

/// Notes the kinds of the rows that hold a solution, and their guides.
void JointCycle::note_held(const Solution& solution, Trial& trial) const noexcept {
  for (const std::uint32_t number : solution.active) {
    if (number < memory_.rows.size()) {
      const std::size_t owner = memory_.rows[number].owner;
      trial.held.add(owner < most_pairs ? Limit::mesh : Limit::guide);
      if (owner >= most_pairs) trial.guides.set(owner - most_pairs);
    } else {
      const std::size_t side = box_rows_[number - memory_.rows.size()];
      trial.held.add(box_.limit(side / 2, side % 2 == 1));
    }
  }
}

/// Returns true if pulling all guides back takes a motion that leaves one of them again, and that
/// is much longer than to pull them back one by one, and than to relax them. The rows of guides
/// that miss each other by little are nearly opposite: only a very long motion satisfies all of
/// them. `solution` is the motion; the relaxed one if true is returned.
bool JointCycle::is_far_fetched(const JointTask& task, const Softness& tried,
                                const Softness& relaxed, Solution& solution) noexcept {
  constexpr double most = 4.0;
  const auto n = static_cast<std::size_t>(task.joints);
  const auto length_of = [](const Solution& its) {
    return std::sqrt(std::inner_product(its.u.begin(), its.u.end(), its.u.begin(), 0.0));
  };
  JointVector increment{};
  for (std::size_t k = 0; k < n; ++k) increment[k] = task.unit[k] * solution.u[k];
  double one_by_one = 0.0;
  bool bends_too_much = false;
  for (const ContactRow& row : memory_.rows) {
    if (row.owner < most_pairs || !(row.bound > 0.0)) continue;
    double steepest2 = 0.0;
    for (std::size_t k = 0; k < n; ++k) steepest2 += std::pow(task.unit[k] * row.gradient[k], 2);
    if (steepest2 > 0.0) one_by_one += (row.bound + row.correction) / std::sqrt(steepest2);
    bends_too_much = bends_too_much || guides_.bends_by_more(row, {increment.data(), n});
  }
  const double length = length_of(solution);
  if (!bends_too_much || !(length > most * one_by_one)) return false;
  const bool is_shorter = pose(task, relaxed, solution) == SolveStatus::optimal &&
                          length > most * (one_by_one + length_of(solution));
  if (!is_shorter) pose(task, tried, solution);
  return is_shorter;
}

/// Returns the least change of a body row's height that a motion must make. [length]
double JointCycle::body_bound(const ContactRow& row, const Softness& softness) const noexcept {
  const double bound = (row.bound > 0.0 ? softness.bodies * row.bound : row.bound) + row.correction;
  return (softness.bodies > 0.0 ? bound : std::min(bound, 0.0)) - row.drift -
         watch_.given_way(row.owner);
}

/// Returns the same for a guide's row. A relaxed guide that is out of its region is held to the
/// region grown by what the guide may be out in this cycle, less a fraction of its band.
/// [length or rad]
double JointCycle::guide_bound(const ContactRow& row, const Softness& softness) const noexcept {
  double bound = row.bound;
  if (softness.unused < 1.0) {
    const double out = guides_.allowance(row.owner - most_pairs, softness.unused);
    bound = std::min(bound, -row.start_height - out);
  }
  if (!softness.pulls_guides) bound = std::min(bound, 0.0);
  bound += row.correction;
  return softness.bodies > 0.0 ? bound : std::min(bound, 0.0);
}

SolveStatus JointCycle::pose(const JointTask& task, const Softness& softness,
                             Solution& solution) noexcept {
  const auto n = static_cast<std::size_t>(task.joints);
  double* number = memory_.matrix.data();
  std::size_t count = 0;
  for (const ContactRow& row : memory_.rows) {
    double steepest = 0.0;
    if (left_out_[row.owner]) {
      number = std::fill_n(number, n, 0.0);
      memory_.bounds[count++] = 0.0;
      continue;
    }
    for (std::size_t k = 0; k < n; ++k) {
      *number++ = task.unit[k] * row.gradient[k];
      steepest = std::max(steepest, std::abs(number[-1]));
    }
    double least = row.owner < most_pairs ? body_bound(row, softness) : guide_bound(row, softness);
    // A row that no joint can change must not demand a motion; the certificate decides if it is
    // safe.
    if (steepest <= memory_.tolerance) least = std::min(least, 0.0);
    memory_.bounds[count++] = least;
  }
  std::size_t box_rows = 0;
  for (std::size_t k = 0; k < n; ++k) {
    for (const double sign : {1.0, -1.0}) {
      const double bound = sign > 0.0 ? box_.low()[k] : -box_.high()[k];
      if (!std::isfinite(bound)) continue;
      std::fill_n(number, n, 0.0);
      number[k] = sign;
      number += n;
      memory_.bounds[count++] = bound / task.unit[k];
      box_rows_[box_rows++] = static_cast<std::uint8_t>(2 * k + (sign > 0.0 ? 0 : 1));
    }
  }
  const StepProblem problem{{task.jacobian.data(), task.rows, task.joints},
                            {task.desired.data(), task.rows},
                            {memory_.matrix.data(), static_cast<Eigen::Index>(count), task.joints},
                            {memory_.bounds.data(), static_cast<Eigen::Index>(count)},
                            task.damping};
  solution = {};
  const SolveStatus solved = memory_.solver.solve(problem, solution);
  memory_.budget.spend(4 + static_cast<std::size_t>(std::max(solution.iterations, 0)) *
                               (2 + count / 4));
  return solved;
}

}  // namespace keepout
