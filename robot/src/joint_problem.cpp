// SPDX-License-Identifier: BSD-3-Clause
#include "joint_problem.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace keepout {

/// One stage of the relaxation of rows that pull back.
struct JointProblem::Stage {
  Relaxation relaxation;
  double unused;      // the fraction of a guide's band that is left to curvature; 1: no relaxation,
                      // rows keep their bounds
  bool pulls_guides;  // rows of guides may demand a motion towards their regions
  double recovery;    // the fraction of a body's retreat that rows demand; 0: no row demands motion

  static const Stage all[7];
  static constexpr std::size_t holding = 2;     // the first stage that does not pull guides
  static constexpr std::size_t whole_band = 3;  // the first stage that uses all of the band
  static constexpr std::size_t softest = 6;     // zero motion satisfies it beside still meshes
};

// Guides are relaxed first.
constexpr JointProblem::Stage JointProblem::Stage::all[7] = {
    {.relaxation = Relaxation::none, .unused = 1.0, .pulls_guides = true, .recovery = 1.0},
    {.relaxation = Relaxation::guides, .unused = 0.5, .pulls_guides = true, .recovery = 1.0},
    {.relaxation = Relaxation::guides, .unused = 0.5, .pulls_guides = false, .recovery = 1.0},
    {.relaxation = Relaxation::guides, .unused = 0.0, .pulls_guides = false, .recovery = 1.0},
    {.relaxation = Relaxation::recovery, .unused = 0.0, .pulls_guides = false, .recovery = 0.5},
    {.relaxation = Relaxation::recovery, .unused = 0.0, .pulls_guides = false, .recovery = 0.25},
    {.relaxation = Relaxation::recovery, .unused = 0.0, .pulls_guides = false, .recovery = 0.0}};

Proposal JointProblem::solve(const JointTask& task, std::span<const Row> rows) noexcept {
  Solution solution;
  Proposal proposal;
  bool guides_pull = false;
  bool bodies_pull = false;
  for (const Row& row : rows) {
    bool& pull = is_guide(row.owner) ? guides_pull : bodies_pull;
    pull = pull || row.bound > 0.0;
  }
  for (std::size_t i = 0; i < std::size(Stage::all); ++i) {
    const Stage& stage = Stage::all[i];
    if (stage.relaxation == Relaxation::guides && !guides_pull) continue;
    if (guides_pull && i < first_guide_stage_) continue;
    proposal.status = solve_once(task, rows, stage, {}, solution);
    proposal.relaxation = stage.relaxation;
    // If no body is pulled back, the recovery stages can relax only guides. The first of them lets
    // guides that are not pulled use their bands, too. The second repeats the first. The last one
    // drops demands of corrections for motion. (Without rows of guides, the first repeats stage 0.
    // If guides are pulled, it repeats the stage before.)
    if (stage.relaxation == Relaxation::recovery && !bodies_pull) {
      proposal.relaxation =
          guides_pull || may_leave_more(rows) ? Relaxation::guides : Relaxation::none;
    }
    const bool is_solved = proposal.status == SolveStatus::optimal;
    if (i < Stage::whole_band && is_solved && guides_pull &&
        try_relaxed_instead(task, rows, stage, Stage::all[Stage::whole_band], solution)) {
      first_guide_stage_ = std::max(first_guide_stage_, i + 1);
      continue;
    }
    if (is_solved || proposal.status == SolveStatus::ill_posed) break;
  }
  if (proposal.status != SolveStatus::optimal) return proposal;
  for (std::size_t k = 0; k < static_cast<std::size_t>(task.joints); ++k) {
    if (!std::isfinite(solution.u[k])) {
      proposal.status = SolveStatus::iteration_limit;
      return proposal;
    }
    proposal.increment[k] = task.unit[k] * solution.u[k];
  }
  proposal.active = solution.active;
  describe_active(rows, proposal);
  if (box_.clip(proposal.increment)) proposal.limits.add(Limit::joint_position);
  return proposal;
}

bool JointProblem::relax_guides(std::span<const Row> rows) noexcept {
  const bool is_any_pulled = std::any_of(rows.begin(), rows.end(), [](const Row& row) {
    return is_guide(row.owner) && row.bound > 0.0;
  });
  if (!is_any_pulled || first_guide_stage_ >= Stage::holding) return false;
  ++first_guide_stage_;
  return true;
}

OwnerSet JointProblem::conflict(const JointTask& task, std::span<const Row> rows) noexcept {
  OwnerSet owners;
  for (const Row& row : rows) owners.set(row.owner);
  OwnerSet left_out;
  Solution solution;
  for (std::size_t owner = 0; owner < owners.size() && !memory_.budget.is_spent(); ++owner) {
    if (!owners[owner]) continue;
    left_out.set(owner);
    const SolveStatus solved =
        solve_once(task, rows, Stage::all[Stage::softest], left_out, solution);
    if (solved == SolveStatus::optimal) left_out.reset(owner);
  }
  return owners & ~left_out;
}

/// Returns true if any row of a guide allows more in the recovery stages than in the first stage.
bool JointProblem::may_leave_more(std::span<const Row> rows) const noexcept {
  return std::any_of(rows.begin(), rows.end(), [&](const Row& row) {
    return is_guide(row.owner) &&
           guide_bound(row, Stage::all[Stage::whole_band]) < guide_bound(row, Stage::all[0]);
  });
}

/// Notes the kinds of the active rows of a solution, and their guides.
void JointProblem::describe_active(std::span<const Row> rows, Proposal& proposal) const noexcept {
  for (const std::uint32_t number : proposal.active) {
    if (number < rows.size()) {
      ++proposal.active_rows;
      const std::size_t owner = rows[number].owner;
      proposal.limits.add(is_guide(owner) ? Limit::guide : Limit::mesh);
      if (is_guide(owner)) proposal.guides.set(guide_of(owner));
    } else {
      const std::size_t side = box_rows_[number - rows.size()];
      proposal.limits.add(box_.limit(static_cast<int>(side / 2) + 1, side % 2 == 1));
    }
  }
}

/// Tries the stage `relaxed` if the motion of the stage `tried` is unreasonably long. That motion
/// may leave a guide again that it pulls back, and is much longer than all single pulls together.
/// (Rows of guides that almost contradict each other are nearly opposite, so only a very long
/// motion satisfies all of them.) Returns true if the motion is also much longer than the relaxed
/// motion. Then `solution` is meaningless, and the caller continues with its next stage. If false,
/// `solution` is that of `tried`, which may have been solved again.
bool JointProblem::try_relaxed_instead(const JointTask& task, std::span<const Row> rows,
                                       const Stage& tried, const Stage& relaxed,
                                       Solution& solution) noexcept {
  constexpr double most = 4.0;
  const auto n = static_cast<std::size_t>(task.joints);
  const auto length_of = [](const std::span<const double> u) {
    return std::sqrt(std::inner_product(u.begin(), u.end(), u.begin(), 0.0));
  };
  JointVector increment{};
  for (std::size_t k = 0; k < n; ++k) increment[k] = task.unit[k] * solution.u[k];
  double one_by_one = 0.0;
  bool bends_too_much = false;
  for (const Row& row : rows) {
    if (!is_guide(row.owner) || !(row.bound > 0.0)) continue;
    double steepest2 = 0.0;
    for (std::size_t k = 0; k < n; ++k) steepest2 += std::pow(task.unit[k] * row.gradient[k], 2);
    if (steepest2 > 0.0) one_by_one += (row.bound + row.correction) / std::sqrt(steepest2);
    bends_too_much = bends_too_much || guides_.may_leave_again(row, {increment.data(), n});
  }
  const double length = length_of(solution.u);
  if (!bends_too_much || !(length > most * one_by_one)) return false;
  const bool is_shorter = solve_once(task, rows, relaxed, {}, solution) == SolveStatus::optimal &&
                          length > most * (one_by_one + length_of(solution.u));
  if (!is_shorter) solve_once(task, rows, tried, {}, solution);
  return is_shorter;
}

/// Returns the least gradient . dq of a body's row: the change of height that the row demands,
/// minus the drift by the mesh's motion, minus the degradation. [length]
double JointProblem::body_bound(const Row& row, const Stage& stage) const noexcept {
  const double bound = (row.bound > 0.0 ? stage.recovery * row.bound : row.bound) + row.correction;
  return (stage.recovery > 0.0 ? bound : std::min(bound, 0.0)) - row.drift -
         pairs_.degradation(row.owner);
}

/// Like body_bound(), but for a guide's row. A relaxed guide outside its region must stay in a
/// larger region: the excess that this cycle allows, minus a fraction of the guide's band. [length
/// or rad]
double JointProblem::guide_bound(const Row& row, const Stage& stage) const noexcept {
  double bound = row.bound;
  if (stage.unused < 1.0) {
    const double out = guides_.allowance(guide_of(row.owner), stage.unused);
    bound = std::min(bound, -row.start_height - out);
  }
  if (!stage.pulls_guides) bound = std::min(bound, 0.0);
  bound += row.correction;
  return stage.recovery > 0.0 ? bound : std::min(bound, 0.0);
}

/// Solves the problem of one stage. The rows of owners that are left out become empty rows.
SolveStatus JointProblem::solve_once(const JointTask& task, std::span<const Row> rows,
                                     const Stage& stage, const OwnerSet& left_out,
                                     Solution& solution) noexcept {
  const auto n = static_cast<std::size_t>(task.joints);
  double* entry = memory_.matrix.data();
  std::size_t count = 0;
  for (const Row& row : rows) {
    double largest_entry = 0.0;
    if (left_out[row.owner]) {
      entry = std::fill_n(entry, n, 0.0);
      memory_.bounds[count++] = 0.0;
      continue;
    }
    for (std::size_t k = 0; k < n; ++k) {
      *entry++ = task.unit[k] * row.gradient[k];
      largest_entry = std::max(largest_entry, std::abs(entry[-1]));
    }
    double least = is_guide(row.owner) ? guide_bound(row, stage) : body_bound(row, stage);
    // A row that no joint can change must not demand a motion; the certificate decides if it is
    // safe.
    if (largest_entry <= memory_.tolerance) least = std::min(least, 0.0);
    memory_.bounds[count++] = least;
  }
  std::size_t box_rows = 0;
  for (std::size_t k = 0; k < n; ++k) {
    for (const double sign : {1.0, -1.0}) {
      const double bound = sign > 0.0 ? box_.low()[k] : -box_.high()[k];
      if (!std::isfinite(bound)) continue;
      std::fill_n(entry, n, 0.0);
      entry[k] = sign;
      entry += n;
      memory_.bounds[count++] = bound / task.unit[k];
      box_rows_[box_rows++] = static_cast<std::uint8_t>(2 * k + (sign > 0.0 ? 0 : 1));
    }
  }
  const StepProblem problem{{task.jacobian.data(), task.equations, task.joints},
                            {task.desired.data(), task.equations},
                            {memory_.matrix.data(), static_cast<Eigen::Index>(count), task.joints},
                            {memory_.bounds.data(), static_cast<Eigen::Index>(count)},
                            task.damping,
                            {},
                            {box_rows_.data(), box_rows}};
  solution = {};
  const SolveStatus solved = memory_.solver.solve(problem, solution);
  memory_.budget.spend_solve(n, count, solution.iterations);
  return solved;
}

}  // namespace keepout
