// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "keepout/activation/activation.h"
#include "keepout/index/refine.h"
#include "keepout/index/spatial_index.h"
#include "keepout/step/branches.h"
#include "keepout/step/motion.h"
#include "keepout/step/problem.h"

namespace keepout {

/// Room for the largest step that shall be solved; a step that needs more ends with over_capacity.
struct Capacity {
  /// Candidates of one query. The form of the certified rule that searches the index by itself
  /// makes no such query and does not heed it; it has budgets of its own: 4096 triangles asked
  /// about in double, and 131072 looks at leaves a cycle.
  std::size_t triangles = std::size_t{1} << 16;
  std::size_t planes = std::size_t{1} << 14;  // that a rule may pose at the same time
  std::size_t variables = 7;                  // columns of the Jacobian, or 3 without one
  std::size_t extra_rows = 64;                // of the caller's own
  std::size_t nodes = 0;                      // of the branch and bound
};

/// Whether a problem has rows for its planes, or leaves them to a solver that reads planes.
enum class PlaneRows : std::uint8_t { written, left_out };

/// All the memory of a step, made once. One for each thread.
class Workspace {
 public:
  /// Makes all memory here.
  explicit Workspace(const Capacity& capacity);

  /// The most columns of a Jacobian; at least 3.
  Eigen::Index variables() const noexcept { return variables_; }
  /// The most rows of the caller's own.
  Eigen::Index extra_rows() const noexcept { return extra_rows_; }

  /// The problem whose rows are the planes, then those of the caller: on the tip's own increment
  /// without a Jacobian, on the joints' with one, n^T J. `aim`: where the tip shall go. [length]
  /// Precondition: at most variables() joints and extra_rows() rows.
  StepProblem pose(const Motion& motion, const Vec3& aim, double damping,
                   PlaneRows plane_rows = PlaneRows::written) noexcept;

  /// Takes down an answer, which outlives the solver's next one: `share` of the increment, or the
  /// tip's own.
  void note(const Solution& answer, double share) noexcept;
  /// The same where the tip itself is what moves.
  void note(const Solution& answer, const Vec3& increment) noexcept;

  TriangleBuffer candidates;       // of the query, in the order of the index
  HitBuffer hits;                  // of the query, exact and sorted by id
  HalfSpaceBuffer planes;          // that the trial at hand has to satisfy
  HalfSpaceBuffer earlier_planes;  // of the motion that is to be improved upon
  HalfSpaceBuffer ways;            // around one triangle
  Branches branches;               // of the branch and bound
  Solution solution;               // the solver's last one

  /// Puts planes and answer aside, for a search that may find better ones.
  void set_aside() noexcept;

  /// It found none.
  void take_back() noexcept;

  /// What was taken down.
  std::span<const double> increment() const noexcept { return answer_.increment.view(); }
  /// The rows that hold it back: planes, then those of the caller.
  std::span<const std::uint32_t> active() const noexcept { return answer_.active.view(); }

 private:
  struct Answer {
    Buffer<double> increment;      // (variables)
    Buffer<std::uint32_t> active;  // (planes + extra rows)
  };

  Eigen::Index variables_;
  Eigen::Index extra_rows_;
  std::vector<double> jacobian_;  // (3, variables), column by column, of one that is not so
  std::vector<double> rows_;      // (planes + extra rows, variables), row by row
  std::vector<double> bounds_;    // (planes + extra rows)
  Vec3 desired_;
  Answer answer_;
  Answer earlier_answer_;
};

}  // namespace keepout
