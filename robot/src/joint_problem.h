// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "body_watch.h"
#include "guide_watch.h"
#include "increment_box.h"
#include "joint_task.h"
#include "keepout/step/solver.h"

namespace keepout {

/// A set of guides, by number.
using GuideSet = std::bitset<Guide::most>;
/// A set of owners of rows: see Row::owner.
using OwnerSet = std::bitset<most_pairs + Guide::most>;

/// A motion that the solver proposes, and what limits it.
struct Proposal {
  SolveStatus status = SolveStatus::infeasible;
  JointVector increment{};
  Limits limits = {};                          // the kinds of active rows and joint limits
  GuideSet guides = {};                        // whose rows are active
  Relaxation relaxation = Relaxation::none;    // what was relaxed
  std::span<const std::uint32_t> active = {};  // rows, by number; valid until the next solve
};

/// The solver of an instrument and the memory of its problems. Made once for all cycles.
struct ProblemMemory {
  /// Makes memory for so many rows of an instrument of n joints. Allocates.
  ProblemMemory(Solver& solver, int joints, std::size_t rows);

  Solver& solver;
  std::vector<double> matrix;  // of all rows, row by row
  std::vector<double> bounds;
};

/// The quadratic problem of a joint cycle: its bounds, their relaxation, and its solution.
class JointProblem {
 public:
  /// All must outlive it.
  JointProblem(ProblemMemory& memory, const IncrementBox& box, const BodyWatch& bodies,
               const GuideWatch& guides, const CycleContext& context) noexcept
      : memory_(memory), box_(box), bodies_(bodies), guides_(guides), context_(context) {}

  /// Returns the motion that serves a task best within the rows and the limits of the joints.
  /// Relaxes rows that pull back if they contradict each other, if the solver does not converge, or
  /// if guides pull unreasonably far.
  Proposal solve(const JointTask& task, std::span<const Row> rows) noexcept;
  /// Stops pulling guides back into their regions from now on, by the least relaxation that is
  /// left. Returns false if no row pulls a guide back, or if no relaxation is left.
  bool relax_guides(std::span<const Row> rows) noexcept;
  /// Returns a minimal set of owners whose rows contradict each other: each is left out in turn,
  /// and stays out if the others still do.
  OwnerSet conflict(const JointTask& task, std::span<const Row> rows) noexcept;

 private:
  struct Stage;

  SolveStatus solve_once(const JointTask& task, std::span<const Row> rows, const Stage& stage,
                         Solution& solution) noexcept;
  bool is_far_fetched(const JointTask& task, std::span<const Row> rows, const Stage& tried,
                      const Stage& relaxed, Solution& solution) noexcept;
  double body_bound(const Row& row, const Stage& stage) const noexcept;
  double guide_bound(const Row& row, const Stage& stage) const noexcept;
  void describe_active(std::span<const Row> rows, Proposal& proposal) const noexcept;

  ProblemMemory& memory_;
  const IncrementBox& box_;
  const BodyWatch& bodies_;
  const GuideWatch& guides_;
  const CycleContext& context_;
  OwnerSet left_out_ = {};
  std::array<std::uint8_t, 2 * Chain::most_joints> box_rows_{};  // joint and side of each row
  std::size_t relaxed_ = 0;  // the first stage of guides that is left to try in this cycle
};

}  // namespace keepout
