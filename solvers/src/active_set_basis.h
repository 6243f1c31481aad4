// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "active_set_rows.h"

namespace keepout::active_set {

/// The active rows in task space as the columns of Q1 T, where Q = [Q1 Q2] is orthogonal and T
/// upper triangular (Goldfarb & Idnani 1983, section 4). Both are updated when rows enter and
/// leave. Q1 spans the active rows. A motion along Q2 does not change their values.
template <int N>
class Basis {
 public:
  void reserve(int variables) {
    q_.resize(variables, variables);
    t_.resize(variables, variables);
    along_.resize(variables);
    active_.resize(variables);
  }

  void clear(int variables) noexcept {
    n_ = variables;
    size_ = 0;
    is_identity_ = true;
    for (int j = 0; j < n(); ++j) {
      for (int i = 0; i < n(); ++i) q_(i, j) = i == j ? 1 : 0;
    }
  }

  int size() const noexcept { return size_; }
  int row(int i) const noexcept { return active_[i]; }

  /// Computes h = Q^T w.
  void project(const Vector<N>& w, Vector<N>& h) const noexcept {
    if (is_identity_) {
      for (int j = 0; j < n(); ++j) h[j] = w[j];
      return;
    }
    for (int j = 0; j < n(); ++j) {
      h[j] = 0;
      for (int i = 0; i < n(); ++i) h[j] += q_(i, j) * w[i];
    }
  }

  /// Computes y = Q h, using the entries of h from `first` on.
  void combine(const Vector<N>& h, int first, Vector<N>& y) const noexcept {
    if (is_identity_) {
      for (int i = 0; i < n(); ++i) y[i] = i < first ? 0 : h[i];
      return;
    }
    for (int i = 0; i < n(); ++i) y[i] = 0;
    for (int j = first; j < n(); ++j) {
      for (int i = 0; i < n(); ++i) y[i] += q_(i, j) * h[j];
    }
  }

  /// Solves T r = the first size() entries of r, in place.
  void solve(Vector<N>& r) const noexcept {
    for (int j = size_ - 1; j >= 0; --j) {
      r[j] /= t_(j, j);
      for (int i = 0; i < j; ++i) r[i] -= t_(i, j) * r[j];
    }
  }

  /// Solves T^T s = the first size() entries of s, in place.
  void solve_transposed(Vector<N>& s) const noexcept {
    for (int j = 0; j < size_; ++j) {
      for (int i = 0; i < j; ++i) s[j] -= t_(i, j) * s[i];
      s[j] /= t_(j, j);
    }
  }

  /// Returns |w| of an active row.
  double length(int j) const noexcept {
    double square = 0;
    for (int i = 0; i <= j; ++i) square += t_(i, j) * t_(i, j);
    return std::sqrt(square);
  }

  /// Adds a row with h = Q^T w. Reflects Q2 so that its first column spans the new part of the row.
  void add(int row, Vector<N>& h) noexcept {
    double below = 0;
    for (int j = size_ + 1; j < n(); ++j) below += h[j] * h[j];
    const double old = h[size_];
    const double length = std::sqrt(old * old + below);
    const double diagonal = old > 0 ? -length : length;
    if (below > 0) {
      h[size_] = old - diagonal;
      const double scale = 2 / (h[size_] * h[size_] + below);
      combine(h, size_, along_);
      for (int i = 0; i < n(); ++i) along_[i] *= scale;
      for (int j = size_; j < n(); ++j) {
        for (int i = 0; i < n(); ++i) q_(i, j) -= along_[i] * h[j];
      }
      is_identity_ = false;
    }
    for (int i = 0; i < size_; ++i) t_(i, size_) = h[i];
    t_(size_, size_) = below > 0 ? diagonal : old;
    active_[size_++] = row;
  }

  /// Removes the row at `position`. The columns of T to its right move left, and rotations of
  /// neighboring rows make T triangular again.
  void drop(int position) noexcept {
    --size_;
    for (int j = position; j < size_; ++j) {
      active_[j] = active_[j + 1];
      for (int i = 0; i <= j + 1; ++i) t_(i, j) = t_(i, j + 1);
    }
    for (int j = position; j < size_; ++j) {
      is_identity_ = false;
      const double length = std::sqrt(t_(j, j) * t_(j, j) + t_(j + 1, j) * t_(j + 1, j));
      const double c = t_(j, j) / length;
      const double s = t_(j + 1, j) / length;
      for (int l = j; l < size_; ++l) rotate(c, s, t_(j, l), t_(j + 1, l));
      for (int i = 0; i < n(); ++i) rotate(c, s, q_(i, j), q_(i, j + 1));
    }
  }

 private:
  int n() const noexcept { return N == Eigen::Dynamic ? n_ : N; }

  static void rotate(double c, double s, double& x, double& y) noexcept {
    const double rotated = c * x + s * y;
    y = c * y - s * x;
    x = rotated;
  }

  int n_ = 0;
  int size_ = 0;
  bool is_identity_ = false;  // Q is the unit matrix, so products with it are copies
  Matrix<N> q_;
  Matrix<N> t_;
  Vector<N> along_;  // Q h, a temporary
  Eigen::Matrix<int, N, 1> active_;
};

}  // namespace keepout::active_set
