// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bitset>
#include <cstddef>
#include <span>

#include "cycle_memory.h"
#include "trial.h"

namespace keepout {

/// One cycle of an instrument: open, then solve, judge and add rows until a motion is proved, or
/// cut it to the part that is proved; and refine it. Allocates nothing, throws nothing.
///
///     run -> open -> search -> search_fraction -> solve_and_judge -> solve, judge, add_rows
///                                              -> refine
///         -> cut -> report -> carry_out
class JointCycle {
 public:
  /// The meshes in a cycle: they stand still, or move with their velocities.
  enum class Meshes : bool { still, moving };

  /// From q (n). The indices must be current. All must outlive it.
  JointCycle(CycleMemory& memory, const InstrumentOptions& options, std::span<const double> q,
             Meshes meshes) noexcept;

  /// Finds the increment for a task. Precondition: the task is finite. Beside a mesh that moves,
  /// all of a motion is proved or nothing: a part of it would not be safe.
  void run(const JointTask& task, InstrumentStep& result) noexcept;

  /// Returns the fraction of a motion that is proved; status and distance go to the result. Ignores
  /// the limits of the joints. Precondition: the increment is finite.
  double prove(const JointVector& increment, InstrumentStep& result) noexcept;

 private:
  void open(InstrumentStep& result) noexcept;
  void search(const JointTask& task, Trial& best, InstrumentStep& result) noexcept;
  bool search_fraction(const JointTask& task, double asked, Trial& best) noexcept;
  bool solve_and_judge(const JointTask& task, const JointTask& part, Trial& best) noexcept;
  SolveStatus solve(const JointTask& task, Trial& trial) noexcept;
  void judge(Trial& trial) noexcept;
  void forget_obstacles() noexcept;
  void try_motion(const JointVector& increment) noexcept;
  bool strays(const JointTask& task, Trial& trial) noexcept;
  bool add_rows() noexcept;
  void refine(const JointTask& task, const JointTask& part, Trial& best) noexcept;
  void cut(Trial& best) noexcept;
  void carry_out(const Trial& best, InstrumentStep& result) noexcept;
  // Beside meshes that move (beside_moving.cpp).
  void search_beside_moving(const JointTask& task, Trial& best, InstrumentStep& result) noexcept;
  void settle_immovable() noexcept;
  bool stand_still(const JointTask& task, Trial& best) noexcept;
  bool degrade(const JointTask& task, Trial& best) noexcept;
  void prefer_degraded(std::bitset<most_pairs>& pairs) const noexcept;
  bool degrade_conflict(const JointTask& task) noexcept;
  void lower(std::size_t pair, double most, Status reason) noexcept;
  double reachable_fraction(std::size_t pair) const noexcept;
  // The report (joint_report.cpp).
  void note_failure() noexcept;
  void note_guide(std::size_t guide) noexcept;
  void report_limits(const Trial& best, InstrumentStep& result) noexcept;
  void report_guides(const Trial& best, InstrumentStep& result) noexcept;

  bool is_recovering() const noexcept { return bodies_.is_recovering() || guides_.is_recovering(); }
  bool is_spent() const noexcept { return context_.budget.is_spent(); }

  CycleMemory& memory_;
  CycleContext context_;
  IncrementBox box_;
  BodyWatch bodies_;
  GuideWatch guides_;
  WorkingRows rows_;
  JointProblem problem_;
  // The obstacles to the last trial: of guides here, of pairs in CycleMemory::obstacles.
  GuideWatch::Obstacle guide_obstacle_ = {};
  Status search_status_ = Status::free;  // why the last search ended without a proof; or free
  bool is_shortened_ = false;            // the last search was for a fraction of the task
  bool has_strayed_ = false;             // a trial of the last search did: see strays
  Limits stopping_limits_ = {};          // the limits that ended searches
  GuideSet stopping_guides_ = {};        // the guides that ended searches
  int rounds_ = 0;
};

/// Proves a motion of any length, in up to 64 parts if there is more near it than the capacity
/// holds or the budget of a cycle can examine. Restores what steps have certified, and does not
/// slow down near the mesh. Precondition: memory and increment (n) are valid.
MotionProof prove_in_parts(CycleMemory& memory, const InstrumentOptions& options,
                           std::span<const double> q, std::span<const double> increment) noexcept;

}  // namespace keepout
