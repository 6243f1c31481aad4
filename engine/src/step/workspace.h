// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "keepout/activation/activation_rule.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "keepout/step/solver.h"
#include "tip_guides.h"

namespace keepout {

/// A node of the branch and bound: planes, and the nearest motion that they allow.
struct Branch {
  /// A choice of more planes than that is not looked into.
  static constexpr std::size_t most_planes = 24;

  double cost;  // distance from the target [length]
  Vec3 motion;  // [length]

  /// Those that the node was opened with.
  std::span<const HalfSpace> planes() const noexcept { return {planes_.data(), count_}; }

 private:
  friend class Branches;
  std::array<HalfSpace, most_planes> planes_;
  std::size_t count_;
  bool open_;
};

/// The nodes of a search, with memory that is made once. What does not fit is left out: that costs
/// quality and not safety.
class Branches {
 public:
  /// Makes room for that many nodes in a search. Allocates.
  explicit Branches(std::size_t capacity) : branches_(capacity) {}

  /// Forgets all nodes: a new search begins.
  void clear() noexcept { size_ = 0; }

  /// Opens a node; left out when there is no room, or when it has more than Branch::most_planes.
  void push(double cost, const Vec3& motion, std::span<const HalfSpace> planes) noexcept;

  /// The open node of least cost, of equals the first; it is open no longer. Null when there is
  /// none. Valid until clear().
  const Branch* pop_nearest() noexcept;

 private:
  std::vector<Branch> branches_;
  std::size_t size_ = 0;
};

/// The memory in which the planes of a cycle become a problem, and its solution a result. Made
/// once.
class Workspace {
 public:
  /// Makes all memory here. The rows of planes are written unless the solver reads planes.
  Workspace(const Capacity& capacity, const Solver& solver);

  /// Whether there is room for the motion's joints and rows.
  bool has_room_for(const Motion& motion) const noexcept;

  /// The problem whose rows are the planes, those of guides, then those of the caller: on the tip's
  /// own increment without a Jacobian, on the joints' with one, n^T J. `target`: where the tip
  /// shall go. [length] Precondition: has_room_for(motion).
  StepProblem pose(const Motion& motion, const Vec3& target, double damping) noexcept;

  /// Stores the last solution as the result, which outlives the solver's next one: `share` of
  /// it, or where the tip itself is what moves, `tip_motion`. `relaxation`, `limits`: what was
  /// relaxed for it, and what limits it that is no active row.
  void store_result(const Motion& motion, const Vec3& tip_motion, double share,
                    Relaxation relaxation, Limits limits) noexcept;

  /// Stores zero motion as the result, whatever the solver returned last.
  void store_zero_result(const Motion& motion, Relaxation relaxation, Limits limits) noexcept;

  /// Returns the planes and those of guides, as the solver gets them.
  std::span<const HalfSpace> posed() noexcept { return with_guides(guides.planes().size()); }

  TipGuides guides;                // of the tip
  HalfSpaceBuffer planes;          // that the trial at hand has to satisfy
  HalfSpaceBuffer earlier_planes;  // of the motion that is to be improved upon
  HalfSpaceBuffer ways;            // around one triangle
  Branches branches;               // of the branch and bound
  Solution solution;               // the solver's last one

  /// Saves planes and result, for a search that may find better ones.
  void save() noexcept;

  /// Restores them.
  void restore() noexcept;

  /// Returns the increment of the result.
  std::span<const double> increment() const noexcept { return result_.increment.view(); }
  /// The rows that limit it: planes, those of guides, then those of the caller.
  std::span<const std::uint32_t> active() const noexcept { return result_.active.view(); }
  /// Returns the planes and those of guides that it was found with.
  std::span<const HalfSpace> posed_for_result() noexcept {
    return with_guides(result_.guide_planes);
  }
  /// Returns what was relaxed for it.
  Relaxation relaxation() const noexcept { return result_.relaxation; }
  /// Returns what limits it that is no active row.
  Limits limits() const noexcept { return result_.limits; }

 private:
  struct Result {
    Buffer<double> increment;      // (variables)
    Buffer<std::uint32_t> active;  // (planes + those of guides + extra rows)
    std::size_t guide_planes = 0;  // that were posed
    Relaxation relaxation = Relaxation::none;
    Limits limits = {};
  };

  std::span<const HalfSpace> with_guides(std::size_t guide_planes) noexcept {
    return guide_planes == 0 ? planes.view() : joined(guide_planes);
  }
  std::span<const HalfSpace> joined(std::size_t guide_planes) noexcept;
  void write_rows_of(std::span<const HalfSpace> posed, const double* jacobian,
                     Eigen::Index variables) noexcept;

  Eigen::Index variables_;   // the most columns of a Jacobian; at least 3
  Eigen::Index extra_rows_;  // the most rows of the caller's own
  bool writes_planes_;
  std::vector<double> jacobian_;  // (3, variables), column by column, of one that is not so
  std::vector<double> rows_;      // (planes + those of guides + extra rows, variables), row by row
  std::vector<double> bounds_;    // (planes + those of guides + extra rows)
  HalfSpaceBuffer posed_;         // planes and those of guides
  Vec3 desired_ = Vec3::Zero();
  Result result_;
  Result earlier_result_;
};

}  // namespace keepout
