// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "active_set_rows.h"

namespace keepout::active_set {

/// The coordinates y = R u, with [J; sqrt(damping) I] = Q R. In these the cost is the squared
/// distance from one point, |y - c|^2 + constant. R comes from J itself and not from J^T J, whose
/// condition number is the square.
template <int N>
class TaskSpace {
 public:
  void reserve(int variables) {
    r_.resize(variables, variables);
    block_.resize(variables, variables);
    inverse_.resize(variables);
    target_.resize(variables);
    tail_.resize(variables);
    const auto n = static_cast<std::size_t>(variables);
    factored_.reserve(n * n + n);
    factored_variables_ = 0;
  }

  /// Returns false if there is no unique minimizer to working precision.
  bool read(const StepProblem& problem) noexcept {
    problem_ = &problem;
    n_ = static_cast<int>(problem.jacobian.cols());
    desired_ = problem.desired.norm();
    identity_ = problem.damping == 0 && is_identity(problem.jacobian);
    if (identity_) {
      for (int j = 0; j < n(); ++j) target_[j] = problem.desired[j];
      size_ = std::sqrt(static_cast<double>(n()));
      factored_variables_ = 0;
      return true;
    }
    if (!is_factored(problem)) {
      factor();
      condition_ = condition();
      remember(problem);
    }
    return condition_ <= singular;
  }

  const Vector<N>& target() const noexcept { return target_; }  // c
  double desired() const noexcept { return desired_; }          // |d|
  double size() const noexcept { return size_; }                // |R|, Frobenius

  /// Computes a row in task space: R^T w = a.
  void row_to_task(const double* a, Vector<N>& w) const noexcept {
    for (int j = 0; j < n(); ++j) w[j] = a[j];
    if (identity_) return;
    for (int i = 0; i < n(); ++i) {
      w[i] *= inverse_[i];
      for (int j = i + 1; j < n(); ++j) w[j] -= r_(i, j) * w[i];
    }
  }

  /// Transforms a point of task space to the variables: R u = y, in place.
  void point_from_task(Vector<N>& y) const noexcept {
    if (identity_) return;
    for (int j = n() - 1; j >= 0; --j) {
      y[j] *= inverse_[j];
      for (int i = 0; i < j; ++i) y[i] -= r_(i, j) * y[j];
    }
  }

  /// Computes half of the negative gradient of the cost, J^T (d - J u) - damping u.
  void descent(const Vector<N>& u, Vector<N>& g) const noexcept {
    if (identity_) {
      for (int j = 0; j < n(); ++j) g[j] = target_[j] - u[j];
      return;
    }
    const StepProblem& p = *problem_;
    for (int j = 0; j < n(); ++j) g[j] = -p.damping * u[j];
    for (Eigen::Index i = 0; i < p.jacobian.rows(); ++i) {
      double residual = p.desired[i];
      for (int j = 0; j < n(); ++j) residual -= p.jacobian(i, j) * u[j];
      for (int j = 0; j < n(); ++j) g[j] += p.jacobian(i, j) * residual;
    }
  }

 private:
  int n() const noexcept { return N == Eigen::Dynamic ? n_ : N; }

  bool is_identity(const Eigen::Map<const StepProblem::Matrix>& jacobian) const noexcept {
    if (jacobian.rows() != n()) return false;
    for (int j = 0; j < n(); ++j) {
      for (int i = 0; i < n(); ++i) {
        if (jacobian(i, j) != (i == j ? 1.0 : 0.0)) return false;
      }
    }
    return true;
  }

  /// Returns true if J, d and damping are those that were factored last, bit for bit. The solves of
  /// a cycle share them.
  bool is_factored(const StepProblem& p) const noexcept {
    const auto is_same = [](double a, double b) {
      return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    };
    const auto size = static_cast<std::size_t>(p.jacobian.size() + p.desired.size());
    return factored_variables_ == n() && factored_.size() == size &&
           is_same(factored_damping_, p.damping) &&
           std::equal(p.desired.data(), p.desired.data() + p.desired.size(), factored_.data(),
                      is_same) &&
           std::equal(p.jacobian.data(), p.jacobian.data() + p.jacobian.size(),
                      factored_.data() + p.desired.size(), is_same);
  }

  /// Notes what was factored; nothing if it has more than n task rows, which would not fit.
  void remember(const StepProblem& p) noexcept {
    const auto size = static_cast<std::size_t>(p.jacobian.size() + p.desired.size());
    factored_variables_ = size <= factored_.capacity() ? n() : 0;
    if (factored_variables_ == 0) return;
    factored_.assign(p.desired.data(), p.desired.data() + p.desired.size());
    factored_.insert(factored_.end(), p.jacobian.data(), p.jacobian.data() + p.jacobian.size());
    factored_damping_ = p.damping;
  }

  /// Starts from the rows of the damping, which are triangular, and adds J in blocks of n rows. So
  /// any number of task rows needs memory for n rows only.
  void factor() noexcept {
    const StepProblem& p = *problem_;
    for (int j = 0; j < n(); ++j) {
      for (int i = 0; i < n(); ++i) r_(i, j) = 0;
      r_(j, j) = std::sqrt(p.damping);
      target_[j] = 0;
    }
    const int task_rows = static_cast<int>(p.jacobian.rows());
    for (int first = 0; first < task_rows; first += n()) {
      const int count = std::min(n(), task_rows - first);
      for (int j = 0; j < n(); ++j) {
        for (int i = 0; i < count; ++i) block_(i, j) = p.jacobian(first + i, j);
      }
      for (int i = 0; i < count; ++i) tail_[i] = p.desired[first + i];
      fold_in(count);
    }
    double square = 0;
    for (int j = 0; j < n(); ++j) {
      for (int i = 0; i <= j; ++i) square += r_(i, j) * r_(i, j);
      inverse_[j] = 1 / r_(j, j);
    }
    size_ = std::sqrt(square);
  }

  /// Transforms [R c; block tail] to [R' c'; 0 *] by Householder reflections, each of one row of R
  /// and the whole block.
  void fold_in(int count) noexcept {
    for (int j = 0; j < n(); ++j) {
      double below = 0;
      for (int i = 0; i < count; ++i) below += block_(i, j) * block_(i, j);
      if (below == 0) continue;
      const double old = r_(j, j);
      const double length = std::sqrt(old * old + below);
      const double head = old > 0 ? old + length : old - length;
      const double scale = 2 / (head * head + below);
      const auto reflect = [&](double& top, auto&& column) {
        double along = head * top;
        for (int i = 0; i < count; ++i) along += block_(i, j) * column(i);
        along *= scale;
        top -= along * head;
        for (int i = 0; i < count; ++i) column(i) -= along * block_(i, j);
      };
      for (int l = j + 1; l < n(); ++l) reflect(r_(j, l), block_.col(l));
      reflect(target_[j], tail_);
      r_(j, j) = old > 0 ? -length : length;
    }
  }

  /// Returns |R| |R^-1| in Frobenius norms. The diagonal of R alone could be misleading.
  double condition() noexcept {
    double square = 0;
    for (int l = 0; l < n(); ++l) {
      for (int i = 0; i <= l; ++i) tail_[i] = i == l ? 1 : 0;
      for (int j = l; j >= 0; --j) {
        tail_[j] *= inverse_[j];
        for (int i = 0; i < j; ++i) tail_[i] -= r_(i, j) * tail_[j];
        square += tail_[j] * tail_[j];
      }
    }
    return size_ * std::sqrt(square);
  }

  const StepProblem* problem_ = nullptr;
  int n_ = 0;
  bool identity_ = false;
  double desired_ = 0;
  double size_ = 0;
  Matrix<N> r_;        // upper triangle
  Vector<N> inverse_;  // 1 / r_jj, because a division would take most of the time of a substitution
  Vector<N> target_;   // c
  Matrix<N> block_;    // rows of J that are being added to R
  Vector<N> tail_;     // their part of d
  double condition_ = 0;
  // The task that was factored last.
  std::vector<double> factored_;  // d, then J
  double factored_damping_ = 0;
  int factored_variables_ = 0;  // 0: nothing
};

}  // namespace keepout::active_set
