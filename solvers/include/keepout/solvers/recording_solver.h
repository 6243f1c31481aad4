// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "keepout/step/solver.h"

namespace keepout {

/// A step problem that owns its numbers. It does not use Eigen's alignment, which depends on
/// compiler flags: a program compiled with other flags may free the memory.
struct RecordedProblem {
  static constexpr int dynamic = Eigen::Dynamic;  // a size set by the problem
  /// Column by column.
  using Matrix = Eigen::Matrix<double, dynamic, dynamic, Eigen::DontAlign>;
  /// Row by row.
  using RowMatrix = Eigen::Matrix<double, dynamic, dynamic, Eigen::RowMajor | Eigen::DontAlign>;
  using Vector = Eigen::Matrix<double, dynamic, 1, Eigen::DontAlign>;  // of any length

  /// Copies a problem. Precondition: all rows are written, including those of planes.
  explicit RecordedProblem(const StepProblem& problem);

  /// Returns a view of the problem. Valid until this object is moved or destroyed.
  StepProblem view() const noexcept;

  Matrix jacobian;     // J (k, n)
  Vector desired;      // d (k) [length]
  RowMatrix rows;      // A (m, n)
  Vector bounds;       // b (m)
  double damping = 0;  // weight of |u|^2
};

/// Passes each problem to another solver and stores a copy of it, so that other solvers can solve
/// the problems of real steps. Allocates. A problem is not stored if memory is exhausted.
class RecordingSolver final : public Solver {
 public:
  /// Makes a solver that appends to `record`, which must outlive it.
  RecordingSolver(std::unique_ptr<Solver> solver, std::vector<RecordedProblem>& record);

  void reserve(int variables, int rows) override;
  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override;

 private:
  std::unique_ptr<Solver> solver_;
  std::vector<RecordedProblem>& record_;
};

}  // namespace keepout
