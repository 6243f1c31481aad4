// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "active_set_basis.h"
#include "active_set_rows.h"
#include "active_set_task.h"
#include "active_set_tolerances.h"

namespace keepout::active_set {

/// Goldfarb and Idnani's method for N variables (Eigen::Dynamic: any number up to the reserve).
///
/// Multipliers in this class are those of half the cost: J^T (J u - d) + damping u = sum mu_i
/// A_i^T.
template <int N>
class Method {
 public:
  void reserve(int variables, RowStore& store) {
    rows_.reserve(store);
    task_.reserve(variables);
    basis_.reserve(variables);
    for (Vector<N>* v : {&u_, &mu_, &w_, &h_, &r_, &rest_, &step_, &gradient_, &slack_}) {
      v->resize(variables);
    }
  }

  /// Solves a problem. Precondition: the shapes agree and fit the reserve; J, d and damping are in
  /// range.
  SolveStatus solve(const StepProblem& problem) noexcept {
    n_ = static_cast<int>(problem.jacobian.cols());
    iterations_ = 0;
    basis_.clear(n());
    if (const SolveStatus status = rows_.read(problem); status != SolveStatus::optimal) {
      return status;
    }
    if (!task_.read(problem)) return SolveStatus::ill_posed;
    start();

    // Violated rows enter. Without violated rows, the active rows are settled once. The motion is
    // optimal if no row is violated after that either.
    const int budget = 100 + 20 * n();
    while (iterations_ < budget) {
      const int row = rows_.most_violated(u_, feasibility * reach_);
      if (row == no_row && corrected_) return SolveStatus::optimal;
      switch (row != no_row ? enter(row) : settle()) {
        case Outcome::moved:
          break;
        case Outcome::settled:
          return SolveStatus::optimal;
        case Outcome::infeasible:
          return SolveStatus::infeasible;
        case Outcome::lost:
          return SolveStatus::iteration_limit;
        case Outcome::blocked:
          if (corrected_ && negligible(row)) return SolveStatus::optimal;
          if (corrected_ || settle() == Outcome::lost) return SolveStatus::iteration_limit;
      }
    }
    return SolveStatus::iteration_limit;
  }

  const Vector<N>& u() const noexcept { return u_; }
  int active_count() const noexcept { return basis_.size(); }
  int row(int i) const noexcept { return basis_.row(i); }
  double multiplier(int i) const noexcept { return mu_[i]; }
  int iterations() const noexcept { return iterations_; }

 private:
  enum class Outcome {
    moved,       // the rows must be scanned again
    settled,     // no scan is needed
    infeasible,  // proven by weights on the active rows
    blocked,     // the entering row cannot be reached, possibly because of rounding
    lost         // the active rows are almost dependent, or u is too large
  };

  int n() const noexcept { return N == Eigen::Dynamic ? n_ : N; }

  double norm(const Vector<N>& v) const noexcept {
    double square = 0;
    for (int j = 0; j < n(); ++j) square += v[j] * v[j];
    return std::sqrt(square);
  }

  /// Starts at the unconstrained minimum, which is optimal without rows.
  void start() noexcept {
    for (int j = 0; j < n(); ++j) u_[j] = task_.target()[j];
    task_.point_from_task(u_);
    corrected_ = false;
    asked_ = task_.desired() / task_.size();
    reach_ = std::max(norm(u_), asked_);
  }

  /// Returns true for a violation that rounding explains at a vertex of slanted planes.
  bool negligible(int row) const noexcept {
    return rows_.violation(row, u_) <= acceptable * reach_ * rows_.norm(row);
  }

  /// Step 2 of Goldfarb & Idnani: raises the multiplier of a violated row until the row is
  /// satisfied. Drops active rows whose multiplier reaches zero meanwhile.
  Outcome enter(int row) noexcept {
    double mu = 0;
    task_.row_to_task(rows_[row], w_);
    for (;;) {
      const bool independent = split(row);
      double squared = 0;
      for (int j = basis_.size(); j < n(); ++j) squared += h_[j] * h_[j];
      const double violation = std::max(rows_.violation(row, u_), 0.0);
      const double full = independent && squared > 0 ? violation / squared : unbounded;
      const auto [blocking, partial] = longest_dual_step();
      const double t = std::min(full, partial);
      if (!(t < unbounded)) {  // this form also stops for NaN
        return no_point_satisfies(row) ? Outcome::infeasible : Outcome::blocked;
      }

      ++iterations_;
      corrected_ = false;
      if (full != unbounded) move(t);
      for (int i = 0; i < basis_.size(); ++i) mu_[i] = std::max(mu_[i] - t * r_[i], 0.0);
      mu += t;
      if (full <= partial) {
        mu_[basis_.size()] = mu;
        basis_.add(row, h_);
        return Outcome::moved;
      }
      drop(blocking);
    }
  }

  /// Writes the row as a sum of active rows with weights r, plus a rest: h = Q^T w and r = T^-1 h1.
  /// Returns true if the rest exceeds rounding. The rest is measured in u, where it is exact to
  /// rounding for any condition of J.
  bool split(int row) noexcept {
    const int active = basis_.size();
    basis_.project(w_, h_);
    if (active == 0) return true;
    for (int i = 0; i < active; ++i) r_[i] = h_[i];
    basis_.solve(r_);
    double all = 0;
    double tail = 0;
    for (int j = 0; j < n(); ++j) all += h_[j] * h_[j];
    for (int j = active; j < n(); ++j) tail += h_[j] * h_[j];
    if (tail <= cancellation * cancellation * all) {
      find_rest(row);
      task_.row_to_task(rest_.data(), step_);
      basis_.project(step_, gradient_);
      for (int j = 0; j < n(); ++j) h_[j] = j < active ? h_[j] + gradient_[j] : gradient_[j];
      basis_.solve(gradient_);
      for (int i = 0; i < active; ++i) r_[i] += gradient_[i];
    }
    noise_ = dependence * find_rest(row);
    return active < n() && norm(rest_) > noise_;
  }

  /// Computes rest = row - sum r_i (active row i). Returns the sum of the sizes of its terms.
  double find_rest(int row) noexcept {
    double size = rows_.norm(row);
    for (int j = 0; j < n(); ++j) rest_[j] = rows_[row][j];
    for (int i = 0; i < basis_.size(); ++i) {
      const double* a = rows_[basis_.row(i)];
      for (int j = 0; j < n(); ++j) rest_[j] -= r_[i] * a[j];
      size += std::abs(r_[i]) * rows_.norm(basis_.row(i));
    }
    return size;
  }

  /// Returns the longest dual step until an active multiplier reaches zero, and its position. If
  /// two are equal, the first to have entered counts.
  std::pair<int, double> longest_dual_step() const noexcept {
    std::pair<int, double> first{no_row, unbounded};
    for (int i = 0; i < basis_.size(); ++i) {
      if (!(r_[i] * rows_.norm(basis_.row(i)) > noise_)) continue;
      const double t = mu_[i] / r_[i];
      if (t < first.second) first = {i, t};
    }
    return first;
  }

  /// Moves by t along the rest of the entering row, which does not change the active rows' values.
  void move(double t) noexcept {
    basis_.combine(h_, basis_.size(), step_);
    task_.point_from_task(step_);
    for (int j = 0; j < n(); ++j) u_[j] += t * step_[j];
    reach_ = std::max(reach_, norm(u_));
  }

  void drop(int position) noexcept {
    basis_.drop(position);
    for (int i = position; i < basis_.size(); ++i) mu_[i] = mu_[i + 1];
  }

  /// Returns true if no point satisfies the row and the active ones (Farkas). With weights s >= 0,
  /// every such point has (row + sum s_i a_i) u >= b + sum s_i b_i. The left side is at most
  /// rounding, so a clearly positive right side proves it.
  bool no_point_satisfies(int row) noexcept {
    double bound = rows_.bound(row);
    double bound_size = std::abs(bound);
    for (int i = 0; i < basis_.size(); ++i) {
      r_[i] = std::min(r_[i], 0.0);
      bound -= r_[i] * rows_.bound(basis_.row(i));
      bound_size -= r_[i] * std::abs(rows_.bound(basis_.row(i)));
    }
    const double size = find_rest(row);
    const double left = (norm(rest_) + n() * epsilon * size) * horizon * reach_;
    return bound > left + 2 * (n() + 1) * epsilon * bound_size;
  }

  /// Called if no row is violated. Corrects u and mu until the active rows hold and the gradient
  /// balances, up to rounding. Drops rows with negative multipliers. Returns `settled` only if the
  /// rows need no second scan.
  Outcome settle() noexcept {
    ++iterations_;
    for (int j = 0; j < n(); ++j) rest_[j] = u_[j];
    if (!correct()) return Outcome::lost;
    bool dropped = false;
    for (int pulling = most_negative(); pulling != no_row; pulling = most_negative()) {
      drop(pulling);
      ++iterations_;
      dropped = true;
      if (!correct()) return Outcome::lost;
    }
    corrected_ = true;
    for (int i = 0; i < basis_.size(); ++i) mu_[i] = std::max(mu_[i], 0.0);
    for (int j = 0; j < n(); ++j) rest_[j] -= u_[j];
    const double scanned = feasibility * reach_ + norm(rest_);
    reach_ = std::max(norm(u_), asked_);
    if (!(reach_ <= largest)) return Outcome::lost;
    return !dropped && scanned <= 2 * feasibility * reach_ ? Outcome::settled : Outcome::moved;
  }

  /// Newton's correction for the active rows as equations. It uses residuals in u, which are free
  /// of the accumulated errors of the basis updates. Returns false if it does not converge.
  bool correct() noexcept {
    Residual left = residual();
    for (int pass = 0; pass < 4 && left.worst() > rounding; ++pass) {
      const double before = left.worst();
      apply_correction();
      left = residual();
      if (left.worst() > before / 2) break;
    }
    return left.slack <= acceptable && left.imbalance <= acceptable;
  }

  struct Residual {
    double slack;      // of the active rows, relative to their norm and the reach
    double gradient;   // in task space, relative to |d|, |J| |u| and the multipliers
    double imbalance;  // as gradient, but in u; smaller by up to the condition of J
    double worst() const noexcept { return std::max(slack, gradient); }
  };

  /// Writes b - A u of the active rows to slack_, and the unbalanced gradient in task space to h_.
  Residual residual() noexcept {
    double slack = 0;
    double forces = task_.desired() + task_.size() * norm(u_);
    task_.descent(u_, gradient_);
    const double reach = std::max(norm(u_), asked_);
    for (int i = 0; i < basis_.size(); ++i) {
      const double* a = rows_[basis_.row(i)];
      slack_[i] = rows_.violation(basis_.row(i), u_);
      slack = std::max(slack, ratio(std::abs(slack_[i]), rows_.norm(basis_.row(i)) * reach));
      for (int j = 0; j < n(); ++j) gradient_[j] += mu_[i] * a[j];
      forces += std::abs(mu_[i]) * basis_.length(i);
    }
    task_.row_to_task(gradient_.data(), h_);
    return {slack, ratio(norm(h_), forces), ratio(norm(gradient_), task_.size() * forces)};
  }

  void apply_correction() noexcept {
    const int active = basis_.size();
    basis_.project(h_, step_);
    basis_.solve_transposed(slack_);
    for (int i = 0; i < active; ++i) {
      r_[i] = slack_[i] - step_[i];
      step_[i] = slack_[i];
    }
    basis_.solve(r_);
    basis_.combine(step_, 0, h_);
    task_.point_from_task(h_);
    for (int i = 0; i < active; ++i) mu_[i] += r_[i];
    for (int j = 0; j < n(); ++j) u_[j] += h_[j];
  }

  /// Returns the active row with the most negative multiplier times length, if it exceeds the
  /// noise.
  int most_negative() const noexcept {
    double forces = task_.desired();
    for (int i = 0; i < basis_.size(); ++i) forces += std::abs(mu_[i]) * basis_.length(i);
    int worst = no_row;
    double least = -acceptable * forces;
    for (int i = 0; i < basis_.size(); ++i) {
      const double force = mu_[i] * basis_.length(i);
      if (force < least) {
        worst = i;
        least = force;
      }
    }
    return worst;
  }

  static double ratio(double part, double whole) noexcept { return part == 0 ? 0 : part / whole; }

  static constexpr double unbounded = std::numeric_limits<double>::infinity();

  int n_ = 0;
  int iterations_ = 0;
  bool corrected_ = false;  // u and mu are as exact as possible for the active rows
  double asked_ = 0;        // |d| / |J|
  double reach_ = 0;        // largest |u| so far, at least asked_
  double noise_ = 0;        // rounding of the entering row's split, in the unit of the row
  Rows<N> rows_;
  TaskSpace<N> task_;
  Basis<N> basis_;
  Vector<N> u_;
  Vector<N> mu_;  // of the active rows, in the order of the basis
  // The entering row: in task space, in the basis, on active rows, and the rest. Otherwise
  // temporary.
  Vector<N> w_, h_, r_, rest_;
  Vector<N> step_, gradient_, slack_;
};

}  // namespace keepout::active_set
