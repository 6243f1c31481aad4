// SPDX-License-Identifier: BSD-3-Clause
// A solver of your own: Hildreth's method.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "keepout/step/solver.h"

/// Turns the problem into that of the point w = R u nearest to z, with J^T J + damping I = R^T R.
/// It finds w by coordinate ascent on the dual: each sweep corrects one multiplier after another.
/// The code is short, but slow if planes are nearly parallel, and it never proves that a problem is
/// infeasible, unless a row of zeros contradicts itself. Source: Hildreth, "A quadratic programming
/// procedure", Naval Research Logistics Quarterly 4, 1957.
class Hildreth final : public keepout::Solver {
 public:
  void reserve(int variables, int rows) override {
    variables_ = std::min(variables, most_variables);
    forces_.resize(static_cast<std::size_t>(rows));
    rows_.resize(forces_.size());
    multipliers_.reserve(forces_.size());
    active_.reserve(forces_.size());
  }

  keepout::SolveStatus solve(const keepout::StepProblem& problem,
                             keepout::Solution& solution) noexcept override {
    solution = {};
    const Eigen::Index n = problem.jacobian.cols(), m = problem.rows.rows();
    if (!is_valid(problem)) return keepout::SolveStatus::invalid_input;
    if (n > variables_ || m > static_cast<Eigen::Index>(rows_.size())) {
      return keepout::SolveStatus::over_capacity;
    }
    if (!factorize(problem)) return keepout::SolveStatus::ill_posed;
    const auto triangle = factor_.topLeftCorner(n, n).template triangularView<Eigen::Upper>();
    for (Eigen::Index i = 0; i < m; ++i) {
      Vector& row = rows_[static_cast<std::size_t>(i)];
      row = problem.rows.row(i).transpose();
      triangle.transpose().solveInPlace(row);
      if (row.isZero(0.0) && problem.bounds[i] > 0.0) return keepout::SolveStatus::infeasible;
    }

    Vector w = target_;
    std::fill_n(forces_.begin(), m, 0.0);
    const double enough = 1e-14 * w.norm();
    double largest = 1.0;
    int& sweeps = solution.iterations;
    for (; largest > enough && sweeps < most_sweeps; ++sweeps) {
      largest = 0.0;
      for (Eigen::Index i = 0; i < m; ++i) {
        const Vector& row = rows_[static_cast<std::size_t>(i)];
        const double length = row.squaredNorm();
        if (length == 0.0) continue;
        double& force = forces_[static_cast<std::size_t>(i)];
        const double change = std::max(-force, (problem.bounds[i] - row.dot(w)) / length);
        force += change;
        w += change * row;
        largest = std::max(largest, std::abs(change) * std::sqrt(length));
      }
    }
    if (!(largest <= enough)) return keepout::SolveStatus::iteration_limit;  // or infeasible
    active_.clear();
    multipliers_.clear();
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(m); ++i) {
      if (!(forces_[i] > 0.0)) continue;
      active_.push_back(i);
      multipliers_.push_back(2.0 * forces_[i]);  // for |w - z|^2, not for half of it
    }
    triangle.solveInPlace(w);
    u_ = w;
    solution.u = {u_.data(), static_cast<std::size_t>(n)};
    solution.multipliers = multipliers_;
    solution.active = active_;
    return keepout::SolveStatus::optimal;
  }

 private:
  static constexpr int most_variables = 7;
  static constexpr int most_sweeps = 20000;
  /// At most seven numbers, without memory on the heap.
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_variables, 1>;
  using Matrix = Eigen::Matrix<double, most_variables, most_variables>;

  static bool is_valid(const keepout::StepProblem& problem) noexcept {
    const Eigen::Index n = problem.jacobian.cols(), m = problem.rows.rows();
    return n > 0 && problem.desired.size() == problem.jacobian.rows() &&
           problem.bounds.size() == m && (m == 0 || problem.rows.cols() == n) &&
           problem.damping >= 0.0 && std::isfinite(problem.damping) &&
           problem.jacobian.allFinite() && problem.desired.allFinite() &&
           problem.rows.allFinite() && problem.bounds.allFinite();
  }

  /// Computes R and z. Returns false if J lacks full column rank and the damping is 0. Rotates one
  /// row of J and of the damping after the other into R (Givens).
  bool factorize(const keepout::StepProblem& problem) noexcept {
    const Eigen::Index n = problem.jacobian.cols(), k = problem.jacobian.rows();
    factor_.setZero();
    target_.setZero(n);
    Vector row(n);
    double largest = 0.0;  // of the entries
    for (Eigen::Index i = 0; i < k + n; ++i) {
      double right = i < k ? problem.desired[i] : 0.0;
      if (i < k) {
        row = problem.jacobian.row(i).transpose();
      } else {
        row = Vector::Unit(n, i - k) * std::sqrt(problem.damping);
      }
      largest = std::max(largest, row.lpNorm<Eigen::Infinity>());
      for (Eigen::Index j = 0; j < n; ++j) {
        const double length = std::hypot(factor_(j, j), row[j]);
        if (row[j] == 0.0) continue;
        const double c = factor_(j, j) / length, s = row[j] / length;
        for (Eigen::Index l = j; l < n; ++l) {
          const double above = factor_(j, l);
          factor_(j, l) = c * above + s * row[l];
          row[l] = c * row[l] - s * above;
        }
        row[j] = 0.0;
        const double above = target_[j];
        target_[j] = c * above + s * right;
        right = c * right - s * above;
      }
    }
    return factor_.diagonal().head(n).cwiseAbs().minCoeff() > 1e-12 * largest;
  }

  int variables_ = 0;
  Matrix factor_ = Matrix::Zero();  // R
  Vector target_;                   // z
  Vector u_;
  std::vector<Vector> rows_;    // R^-T a
  std::vector<double> forces_;  // >= 0: w = z + sum of forces_i rows_i
  std::vector<double> multipliers_;
  std::vector<std::uint32_t> active_;
};
