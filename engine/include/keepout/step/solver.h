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
  /// The planes that the first rows come from, A_i = n_i^T J, b_i = offset, J (3, n); none if
  /// unknown. For a solver that reads them (Solver::reads_planes) the first rows are not written.
  std::span<const HalfSpace> planes = {};
};

/// Row i of A for a plane: n^T J, J (3, n) column by column. Every sum in one order, so that a row
/// has the same bits whoever writes it.
inline void write_row(const Vec3& normal, const double* jacobian, Eigen::Index variables,
                      double* row) noexcept {
  for (Eigen::Index c = 0; c < variables; ++c, jacobian += 3) {
    row[c] = normal[0] * jacobian[0] + normal[1] * jacobian[1] + normal[2] * jacobian[2];
  }
}

/// Returns true if u is the increment of a point itself: three variables, J = I and no damping. The
/// answer is then the point of the feasible set that is nearest to d.
inline bool moves_a_point(const StepProblem& problem) noexcept {
  if (problem.jacobian.cols() != 3 || problem.jacobian.rows() != 3) return false;
  const double* j = problem.jacobian.data();
  return problem.damping == 0.0 && j[0] == 1.0 && j[1] == 0.0 && j[2] == 0.0 && j[3] == 0.0 &&
         j[4] == 1.0 && j[5] == 0.0 && j[6] == 0.0 && j[7] == 0.0 && j[8] == 1.0;
}

/// How a solve ended. Only `optimal` carries a solution that may be used.
enum class SolveStatus : std::uint8_t {
  optimal,         // feasible, and no feasible point is better
  infeasible,      // no u satisfies all rows
  ill_posed,       // the minimizer is not unique: J lacks full column rank and damping is 0
  invalid_input,   // a number is not finite or out of range, or the shapes do not agree
  over_capacity,   // more variables or rows than reserved
  iteration_limit  // gave up: the budget of work is spent, or rounding hides the answer
};

/// Returns the name as it stands in the enumeration, for files and logs.
std::string_view name(SolveStatus status) noexcept;

/// Returns the status of a step whose solve ended so; free for an optimal solution.
Status status_of(SolveStatus status) noexcept;

/// What a solver leaves behind. Views into the solver's own memory, valid until its next solve.
struct Solution {
  std::span<const double> u;              // (n); meaningful only when optimal
  std::span<const double> multipliers;    // (active.size()), >= 0, of the active rows: see Solver
  std::span<const std::uint32_t> active;  // the rows that hold with equality and push
  int iterations = 0;  // of the method's own kind: to compare a solver with itself
};

/// Solves one step problem after another, without allocating.
///
/// At an optimum, 2 J^T (J u - d) + 2 damping u = sum over active rows i of multipliers_i A_i^T.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Reserves memory for problems up to this size. Allocates; all other functions do not.
  virtual void reserve(int variables, int rows) = 0;

  /// Finds the u of least cost that satisfies all rows. Fills `solution` when optimal; otherwise
  /// only its iterations may be used. More variables or rows than reserved: `over_capacity`.
  virtual SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept = 0;

  /// Returns true if it reads rows that come from planes from StepProblem::planes, so that they
  /// need not be written.
  virtual bool reads_planes() const noexcept { return false; }

  /// Returns true if planes that no iterate violates do not change one bit of the answer, and all
  /// iterates for the point nearest to d are its projections on some of the planes, as in a dual
  /// active-set method. A rule may then leave out planes that no projection of d violates.
  virtual bool ignores_idle_planes() const noexcept { return false; }
};

}  // namespace keepout
