// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bitset>
#include <cstddef>
#include <span>

#include "trial.h"
#include "working_rows.h"

namespace keepout {

/// One cycle of an instrument. It solves, judges and adds rows until a motion is proved, or
/// truncates the motion to its proved part, and refines it. Allocates nothing and throws nothing.
/// The calls, in order:
///
///     run
///       open
///       WorkingRows::add_first_rows
///
///       search
///         search_fraction, of the task, then of less of it
///           solve_and_judge: JointProblem::solve, judge, add_rows, and again
///           refine
///
///       or, beside moving meshes, search_beside_moving
///         settle_immovable
///         search_fraction, of the task, a quarter and none of it
///         degrade: relax_guides, stand_still, degrade_conflict, drop a guide, or give_way; and
///                  search_fraction again
///
///       cut
///       report_guides, report_limits
///       carry_out
///       PairWatch::remember_clearances
class JointCycle {
 public:
  /// The velocities of the meshes in a cycle: ignored, as if all stood still, or predicted.
  enum class MeshMotion : bool { ignored, predicted };

  /// Makes a cycle that starts at q (n). Precondition: the indices are current. All arguments must
  /// outlive the cycle.
  JointCycle(CycleMemory& memory, const InstrumentOptions& options, std::span<const double> q,
             MeshMotion mesh_motion) noexcept;

  /// Returns the chain as the cycle starts, for the task.
  const ChainState& chain_at_start() const noexcept {
    return memory_.trial_motion.chain_at_start();
  }

  /// Finds the increment for a task. Precondition: the task is finite. Beside a moving mesh,
  /// returns a motion only if all of it is proved: a part of it would not be safe.
  InstrumentStep run(const JointTask& task) noexcept;

  /// Returns the fraction of a motion that is proved. Ignores the limits of the joints.
  /// Precondition: the increment is finite.
  MotionProof prove(const JointVector& increment) noexcept;

 private:
  /// The result of the proof of a trial motion. The obstacles of pairs are in
  /// CycleMemory::obstacles until the next motion is judged; a pair that was not judged has none.
  struct Judgement {
    int knot = 0;                  // the motion is proved up to here
    Status status = Status::free;  // or why the triangles near a pair are not known: knot is 0 then
    GuideWatch::Obstacle guide = {};
  };

  PairWatch::Opening open() noexcept;
  Status search(const JointTask& task, Trial& best) noexcept;
  bool search_fraction(const JointTask& task, double asked, Trial& best) noexcept;
  bool solve_and_judge(const JointTask& task, const JointTask& reduced, Trial& best) noexcept;
  void set_trial(const JointVector& increment) noexcept;
  Judgement judge(const JointVector& increment) noexcept;
  void forget_obstacles() noexcept;
  bool measure_flange(const JointTask& task, Trial& trial) noexcept;
  bool add_rows() noexcept;
  Status refine(const JointTask& task, const JointTask& reduced, Trial& best) noexcept;
  void cut(Trial& best) noexcept;
  void carry_out(const Trial& best, InstrumentStep& result) noexcept;
  static Status outcome(const Trial& best, double asked) noexcept;
  // Beside meshes that move (beside_moving.cpp).
  Status search_beside_moving(const JointTask& task, Trial& best) noexcept;
  void settle_immovable() noexcept;
  bool stand_still(const JointTask& task, Trial& best) noexcept;
  bool degrade(const JointTask& task, Trial& best) noexcept;
  void prefer_degraded(std::bitset<most_pairs>& pairs) const noexcept;
  bool degrade_conflict(const JointTask& task) noexcept;
  void give_way(std::size_t p, double most, Status reason) noexcept;
  double reachable_level(std::size_t p) const noexcept;
  // The report (joint_report.cpp).
  void note_failure() noexcept;
  void note_guide(std::size_t guide) noexcept;
  void note_end(Status status) noexcept;
  void report_guides(const Trial& best, bool is_cut, InstrumentStep& result) noexcept;
  void report_limits(const Trial& best, bool is_cut, InstrumentStep& result) noexcept;

  bool is_recovering() const noexcept { return pairs_.is_recovering() || guides_.is_recovering(); }
  bool is_spent() const noexcept { return memory_.budget.is_spent(); }

  CycleMemory& memory_;
  CycleConstants cycle_;
  IncrementBox box_;
  PairWatch pairs_;
  GuideWatch guides_;
  WorkingRows rows_;
  JointProblem problem_;
  Judgement judgement_ = {};             // of the last trial
  Status search_status_ = Status::free;  // of the last search if it found no proof; or free
  bool is_shortened_ = false;            // the last search was for a fraction of the task
  bool has_strayed_ = false;             // a trial of the last search strayed: see measure_flange
  Limits stopping_limits_ = {};          // the limits that ended searches
  GuideSet stopping_guides_ = {};        // the guides that ended searches
  int rounds_ = 0;
};

/// Proves a motion of any length. Divides it into up to 64 parts if the triangles near it exceed
/// the capacity, or the work exceeds the budget of a cycle. Restores the certified clearances of
/// the steps, and ignores slowing_within. Precondition: memory and increment (n) are valid.
MotionProof prove_in_parts(CycleMemory& memory, const InstrumentOptions& options,
                           std::span<const double> q, std::span<const double> increment) noexcept;

}  // namespace keepout
