// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "keepout/step/solver.h"

namespace keepout {

/// A step problem that owns its numbers. Its memory is the standard library's, not aligned as Eigen
/// does for the machine compiled for: it is made here and may be let go by a program for another.
struct RecordedProblem {
  static constexpr int dynamic = Eigen::Dynamic;  // as many as the problem has
  /// Column by column.
  using Matrix = Eigen::Matrix<double, dynamic, dynamic, Eigen::DontAlign>;
  /// Row by row.
  using RowMatrix = Eigen::Matrix<double, dynamic, dynamic, Eigen::RowMajor | Eigen::DontAlign>;
  using Vector = Eigen::Matrix<double, dynamic, 1, Eigen::DontAlign>;  // of any length

  /// Copies all its numbers. Precondition: its rows are written, those of planes as well.
  explicit RecordedProblem(const StepProblem& problem);

  /// The problem again. Valid as long as this lives, and stays where it is.
  StepProblem view() const noexcept;

  Matrix jacobian;     // J (k, n)
  Vector desired;      // d (k) [length]
  RowMatrix rows;      // A (m, n)
  Vector bounds;       // b (m)
  double damping = 0;  // weight of |u|^2
};

/// Passes every problem on to another solver, and keeps a copy of it: to pose the problems of real
/// steps again, to other solvers. Allocates; a problem that there is no memory for is not kept.
class RecordingSolver final : public Solver {
 public:
  /// `record` must outlive the solver.
  RecordingSolver(std::unique_ptr<Solver> solver, std::vector<RecordedProblem>& record);

  void reserve(int variables, int rows) override;
  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override;

 private:
  std::unique_ptr<Solver> solver_;
  std::vector<RecordedProblem>& record_;
};

}  // namespace keepout
