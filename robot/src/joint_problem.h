// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>

#include "guide_watch.h"
#include "increment_box.h"
#include "joint_task.h"
#include "pair_watch.h"

namespace keepout {

/// A set of guides, by number.
using GuideSet = std::bitset<Guide::most>;
/// A set of owners of rows: see Row::owner.
using OwnerSet = std::bitset<most_pairs + Guide::most>;

/// A motion that the solver proposes, and what limits it.
struct Proposal {
  JointVector increment{};
  SolveStatus status = SolveStatus::infeasible;
  Limits limits = {};                          // the kinds of active rows and joint limits
  GuideSet guides = {};                        // the guides whose rows are active
  std::size_t active_rows = 0;                 // the number of active rows, without joint limits
  Relaxation relaxation = Relaxation::none;    // the constraints that were relaxed
  std::span<const std::uint32_t> active = {};  // rows, by number; valid until the next solve
};

/// The quadratic program of a joint cycle: its bounds, their relaxation, and its solution.
class JointProblem {
 public:
  /// All arguments must outlive this object.
  JointProblem(CycleMemory& memory, const IncrementBox& box, const PairWatch& pairs,
               const GuideWatch& guides) noexcept
      : memory_(memory), box_(box), pairs_(pairs), guides_(guides) {}

  /// Returns the motion that serves a task best within the rows and the limits of the joints.
  /// Relaxes rows that pull back if they contradict each other, if the solver does not converge, or
  /// if guides pull unreasonably far.
  Proposal solve(const JointTask& task, std::span<const Row> rows) noexcept;
  /// Relaxes the pull on guides by one stage, for the rest of this cycle. Returns false if no row
  /// pulls a guide back, or if the stage does not pull guides any more.
  bool relax_guides(std::span<const Row> rows) noexcept;
  /// Returns a minimal set of owners whose rows contradict each other. Leaves out each owner in
  /// turn, for good if the other rows still contradict each other.
  OwnerSet conflict(const JointTask& task, std::span<const Row> rows) noexcept;

 private:
  struct Stage;

  SolveStatus solve_once(const JointTask& task, std::span<const Row> rows, const Stage& stage,
                         const OwnerSet& left_out, Solution& solution) noexcept;
  bool try_relaxed_instead(const JointTask& task, std::span<const Row> rows, const Stage& tried,
                           const Stage& relaxed, Solution& solution) noexcept;
  bool may_leave_more(std::span<const Row> rows) const noexcept;
  double body_bound(const Row& row, const Stage& stage) const noexcept;
  double guide_bound(const Row& row, const Stage& stage) const noexcept;
  void describe_active(std::span<const Row> rows, Proposal& proposal) const noexcept;

  CycleMemory& memory_;
  const IncrementBox& box_;
  const PairWatch& pairs_;
  const GuideWatch& guides_;
  // The joint limits of the last problem: 2 k for the lower one of joint k, from 0, 2 k + 1 for the
  // upper one.
  std::array<std::uint8_t, 2 * Chain::most_joints> box_rows_{};
  std::size_t first_guide_stage_ = 0;  // the first stage to try in this cycle if guides are pulled
};

}  // namespace keepout
