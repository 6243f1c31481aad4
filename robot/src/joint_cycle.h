// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bitset>
#include <cstddef>
#include <span>

#include "body_watch.h"
#include "cycle_memory.h"
#include "guide_watch.h"
#include "increment_box.h"
#include "joint_task.h"
#include "working_rows.h"

namespace keepout {

/// One step of the relaxation of rows.
struct Softness {
  Relaxation name;
  double unused;      // the fraction of a guide's band that is left to curvature; 1: no relaxation
  bool pulls_guides;  // towards their regions; false: they only hold
  double bodies;      // the fraction of a body's recovery that is demanded
};

/// One cycle of an instrument: solve, judge, add rows, until the motion is certified; then the
/// increment is it, or the part of one that was. Allocates nothing, throws nothing.
class JointCycle {
 public:
  /// Whether the meshes move in the cycle as they are said to, or stay where they are.
  enum class Meshes : bool { still, moving };

  /// From q (n). The indices must be current. All must outlive it.
  JointCycle(CycleMemory& memory, const InstrumentOptions& options, std::span<const double> q,
             Meshes meshes) noexcept;

  /// Precondition: the task is finite. Where a mesh moves, all of a motion is proven or nothing: to
  /// stop on the way is not safe there.
  void run(const JointTask& task, InstrumentStep& result) noexcept;

  /// The share of a motion that is certified; status and distance go to the result. Limits of
  /// joints are not looked at. Precondition: the increment is finite.
  double prove(const JointVector& increment, InstrumentStep& result) noexcept;

 private:
  using GuideSet = std::bitset<Guide::most>;

  /// A motion, and the part of it that is certified.
  struct Trial {
    JointVector increment{};
    int cell = 0;          // proven is the motion up to here
    double share = 0.0;    // of the motion, up to there, that is made: whatever costs least
    double cost = 0.0;     // of that
    double missed = 0.0;   // of a task of the flange, by its true motion: see strays
    Limits held = {};      // by which kinds of rows or limits of joints
    GuideSet guides = {};  // whose rows hold it
    std::size_t rows = 0;  // that hold it, limits of joints apart
    Relaxation relaxation = Relaxation::none;  // what gave way
  };

  void search(const JointTask& task, Trial& best, InstrumentStep& result) noexcept;
  // Beside meshes that move (beside_moving.cpp).
  void search_beside_moving(const JointTask& task, Trial& best, InstrumentStep& result) noexcept;
  void settle_immovable() noexcept;
  bool stand_still(const JointTask& task, Trial& best) noexcept;
  bool degrade(const JointTask& task, Trial& best) noexcept;
  void prefer_lowered(std::bitset<most_pairs>& pairs) const noexcept;
  bool degrade_conflict(const JointTask& task) noexcept;
  double reachable_level(std::size_t pair) const noexcept;
  bool attempt(const JointTask& task, double asked, Trial& best) noexcept;
  bool seek(const JointTask& task, const JointTask& part, Trial& best) noexcept;
  void turn(const JointTask& task, const JointTask& part, Trial& best) noexcept;
  // The problem (joint_problem.cpp).
  SolveStatus solve(const JointTask& task, Trial& trial) noexcept;
  bool relax_guides() noexcept;
  SolveStatus pose(const JointTask& task, const Softness& softness, Solution& solution) noexcept;
  bool is_far_fetched(const JointTask& task, const Softness& tried, const Softness& relaxed,
                      Solution& solution) noexcept;
  double body_bound(const ContactRow& row, const Softness& softness) const noexcept;
  double guide_bound(const ContactRow& row, const Softness& softness) const noexcept;
  void note_held(const Solution& solution, Trial& trial) const noexcept;
  void judge(Trial& trial) noexcept;
  Status judge_pair(std::size_t pair) noexcept;
  bool answer() noexcept;
  // The true motion of the flange (true_flange.cpp).
  bool strays(const JointTask& task, Trial& trial) noexcept;
  void cut_to_best(const JointTask& task, Trial& trial) noexcept;
  // The report (joint_report.cpp).
  void note_failure() noexcept;
  void note_guide(std::size_t guide) noexcept;
  void report_limits(const Trial& best, InstrumentStep& result) noexcept;
  void report_guides(const Trial& best, InstrumentStep& result) noexcept;
  bool is_recovering() const noexcept { return watch_.is_recovering() || guides_.is_recovering(); }
  void check_cut(Trial& best) noexcept;
  void carry_out(const Trial& best, InstrumentStep& result) noexcept;
  bool is_worn_out() const noexcept { return memory_.budget.is_spent(); }

  CycleMemory& memory_;
  const InstrumentOptions& options_;
  IncrementBox box_;
  BodyWatch watch_;
  GuideWatch guides_;
  WorkingRows rows_;
  int kept_by_guides_ = PointMotion::cells;  // the last trial satisfies all guides up to this cell
  std::size_t failed_guide_ = 0;             // and violates this one beyond
  Status trouble_ = Status::free;            // why nothing can be judged
  bool is_shortened_ = false;                // whether less than all was asked for at last
  bool has_strayed_ = false;                 // a trial of the last attempt: see strays
  Limits stopped_ = {};                      // what attempts failed by
  GuideSet stopping_guides_ = {};            // of these, the guides
  std::bitset<most_pairs + Guide::most> left_out_ = {};          // owners of rows not to be posed
  std::array<std::uint8_t, 2 * Chain::most_joints> box_rows_{};  // of the problem: see pose
  std::size_t relaxed_ = 0;  // the least relaxation of guides that is left to try in this cycle
  bool meshes_move_;
  bool owes_ = false;  // a body owes what rounding took: see Certificate::owes
  int rounds_ = 0;
  std::size_t in_reach_ = 0;  // triangles of one body and one trial, at the most
};

/// Proves a motion of any length, in up to 64 parts if there is more near it than the capacity
/// holds or the budget of a cycle can examine. Leaves what steps have certified as it is, and does
/// not slow down near the mesh. Precondition: memory and increment (n) are valid.
MotionProof prove_in_parts(CycleMemory& memory, const InstrumentOptions& options,
                           std::span<const double> q, std::span<const double> increment) noexcept;

}  // namespace keepout
