// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "keepout/step/problem.h"
#include "keepout/step/solver.h"

namespace keepout {

/// A step problem that owns its numbers. Its memory is the standard library's, not aligned as Eigen
/// does for the machine compiled for: it is made here and may be let go by a program for another.
struct RecordedProblem {
  static constexpr int dynamic = Eigen::Dynamic;
  using Matrix = Eigen::Matrix<double, dynamic, dynamic, Eigen::DontAlign>;
  using RowMatrix = Eigen::Matrix<double, dynamic, dynamic, Eigen::RowMajor | Eigen::DontAlign>;
  using Vector = Eigen::Matrix<double, dynamic, 1, Eigen::DontAlign>;

  explicit RecordedProblem(const StepProblem& problem);

  StepProblem view() const noexcept;

  Matrix jacobian;
  Vector desired;
  RowMatrix rows;
  Vector bounds;
  double damping = 0;
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
