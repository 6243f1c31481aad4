// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string_view>

#include "keepout/geometry/shapes.h"
#include "keepout/status.h"

namespace keepout {

/// The step as a small convex quadratic program (Li et al. 2020, eq. 1):
///
///     min  |J u - d|^2 + damping |u|^2    subject to    A u >= b
///
/// Views only: the caller owns the numbers. n variables, k task rows, m constraints.
struct StepProblem {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;  // column by column
  /// Row by row.
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Vector = Eigen::VectorXd;  // of any length

  Eigen::Map<const Matrix> jacobian;  // J (k, n)
  /// d (k): the target, which is Motion::desired, a part of it, or a retreat: see RuleInput.
  /// [length]
  Eigen::Map<const Vector> desired;
  Eigen::Map<const RowMatrix> rows;  // A (m, n)
  Eigen::Map<const Vector> bounds;   // b (m)
  double damping = 0.0;              // >= 0; above 0 makes any J well-posed
  /// The planes of the first rows, A_i = n_i^T J, b_i = offset, J (3, n); empty if unknown. If the
  /// solver reads planes (Solver::reads_planes), the first rows are not written.
  std::span<const HalfSpace> planes = {};
  /// The bounds of single variables, which are the last rows; empty if unknown. The number 2 k says
  /// that the row has a 1 for u_k and otherwise zeros, 2 k + 1 that it has a -1. The rows are
  /// written all the same.
  std::span<const std::uint8_t> box = {};
};

/// Writes the row of A for a plane: n^T J, with J (3, n) column by column. The order of each sum is
/// fixed, so that all callers write bitwise identical rows.
inline void write_row(const Vec3& normal, const double* jacobian, Eigen::Index variables,
                      double* row) noexcept {
  for (Eigen::Index c = 0; c < variables; ++c, jacobian += 3) {
    row[c] = normal[0] * jacobian[0] + normal[1] * jacobian[1] + normal[2] * jacobian[2];
  }
}

/// Returns true if u is the increment of a point itself: three variables, J = I and no damping. The
/// solution is then the feasible point nearest to d.
inline bool moves_a_point(const StepProblem& problem) noexcept {
  if (problem.jacobian.cols() != 3 || problem.jacobian.rows() != 3) return false;
  const double* j = problem.jacobian.data();
  return problem.damping == 0.0 && j[0] == 1.0 && j[1] == 0.0 && j[2] == 0.0 && j[3] == 0.0 &&
         j[4] == 1.0 && j[5] == 0.0 && j[6] == 0.0 && j[7] == 0.0 && j[8] == 1.0;
}

/// The outcome of a solve. Only `optimal` has a usable solution.
enum class SolveStatus : std::uint8_t {
  optimal,         // feasible, and no feasible point is better
  infeasible,      // no u satisfies all rows
  ill_posed,       // the minimizer is not unique: J lacks full column rank and damping is 0
  invalid_input,   // a number is not finite or out of range, or the shapes do not agree
  over_capacity,   // more variables or rows than reserved
  iteration_limit  // the work limit was reached, or rounding hides the solution
};

/// Returns the name of the enumerator, for files and logs.
std::string_view name(SolveStatus status) noexcept;

/// Returns the status of a step with this outcome of the solve; free for an optimal solution.
Status status_of(SolveStatus status) noexcept;

/// The solution of a problem: views of the solver's memory, valid until its next solve.
struct Solution {
  std::span<const double> u;              // (n); meaningful only if optimal
  std::span<const double> multipliers;    // of the active rows (active.size()), >= 0: see Solver
  std::span<const std::uint32_t> active;  // the rows that hold with equality and limit u
  int iterations = 0;                     // of the solver's method; not comparable between solvers
};

/// Solves step problems without allocating memory.
///
/// At an optimum, 2 J^T (J u - d) + 2 damping u = sum over active rows i of multipliers_i A_i^T.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Reserves memory for problems up to this size. Allocates; all other functions do not.
  virtual void reserve(int variables, int rows) = 0;

  /// Finds the u of least cost that satisfies all rows. Fills `solution` if optimal; otherwise only
  /// its iterations may be used. Returns over_capacity for more variables or rows than reserved.
  virtual SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept = 0;

  /// Returns true if the solver reads StepProblem::planes, so that the rows of planes need not be
  /// written.
  virtual bool reads_planes() const noexcept { return false; }

  /// Returns true if planes that no iterate violates (idle planes) do not change the solution at
  /// all. In addition, all iterates of a moves_a_point() problem must be projections of d. Both
  /// hold for dual active-set methods. A rule may then leave out planes that no projection of d
  /// violates.
  virtual bool ignores_idle_planes() const noexcept { return false; }
};

}  // namespace keepout
