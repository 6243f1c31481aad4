// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "active_set_tolerances.h"
#include "keepout/step/problem.h"
#include "keepout/step/solver.h"

namespace keepout::active_set {

/// Vectors and matrices of N variables; Eigen::Dynamic for a number known at run time only, which
/// then have the reserved size and are used in part. Loops are written out throughout: they do
/// not allocate, and unroll where N is known.
template <int N>
using Vector = Eigen::Matrix<double, N, 1>;
template <int N>
using Matrix = Eigen::Matrix<double, N, N>;

/// The constraints A u >= b, and the squared norm of each row of A.
template <int N>
class Rows {
 public:
  static constexpr int none = -1;

  void reserve(int rows) { squares_.resize(rows); }

  /// Takes the rows in. Anything but `optimal` ends the solve: a number out of range, or a row
  /// of zeros that no u satisfies. Such a row has no length to measure b against, hence b > 0
  /// is infeasible however small.
  SolveStatus read(const StepProblem& problem) noexcept {
    coefficients_ = problem.rows.data();
    bounds_ = problem.bounds.data();
    size_ = static_cast<int>(problem.rows.rows());
    variables_ = static_cast<int>(problem.jacobian.cols());
    SolveStatus status = SolveStatus::optimal;
    for (int i = 0; i < size_; ++i) {
      const double square = dot((*this)[i], (*this)[i]);
      squares_[i] = square;
      const bool usual = square >= smallest * smallest && square <= largest * largest &&
                         std::abs(bounds_[i]) <= largest;
      if (!usual) [[unlikely]] {
        if (!is_zero(i) || !(std::abs(bounds_[i]) <= largest)) return SolveStatus::invalid_input;
        if (bounds_[i] > 0) status = SolveStatus::infeasible;
      }
    }
    return status;
  }

  /// The row violated most, in units of u, of those violated by more than the tolerance; the
  /// lowest of equals. Compares squares: a root and a division a row would cost more than the rest.
  int most_violated(const Vector<N>& u, double tolerance) const noexcept {
    int worst = none;
    double worst_square = tolerance * tolerance;
    for (int i = 0; i < size_; ++i) {
      const double violation = bounds_[i] - dot((*this)[i], u.data());
      if (violation > 0 && violation * violation > worst_square * squares_[i]) [[unlikely]] {
        worst = i;
        worst_square = violation * violation / squares_[i];
      }
    }
    return worst;
  }

  int size() const noexcept { return size_; }
  const double* operator[](int row) const noexcept {
    return coefficients_ + static_cast<std::ptrdiff_t>(row) * n();
  }
  double bound(int row) const noexcept { return bounds_[row]; }
  double norm(int row) const noexcept { return std::sqrt(squares_[row]); }
  double violation(int row, const Vector<N>& u) const noexcept {
    return bounds_[row] - dot((*this)[row], u.data());
  }

 private:
  int n() const noexcept { return N == Eigen::Dynamic ? variables_ : N; }

  double dot(const double* a, const double* b) const noexcept {
    double sum = 0;
    for (int j = 0; j < n(); ++j) sum += a[j] * b[j];
    return sum;
  }

  bool is_zero(int row) const noexcept {
    for (int j = 0; j < n(); ++j) {
      if ((*this)[row][j] != 0) return false;
    }
    return true;
  }

  const double* coefficients_ = nullptr;
  const double* bounds_ = nullptr;
  int size_ = 0;
  int variables_ = 0;
  Eigen::VectorXd squares_;
};

}  // namespace keepout::active_set
