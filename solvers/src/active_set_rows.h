// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "active_set_tolerances.h"
#include "keepout/step/solver.h"
#include "unit_planes.h"

namespace keepout::active_set {

/// Vectors and matrices of N variables. For Eigen::Dynamic they have the reserved size and are used
/// in part. All loops are written out: they do not allocate, and unroll if N is known.
template <int N>
using Vector = Eigen::Matrix<double, N, 1>;
template <int N>
using Matrix = Eigen::Matrix<double, N, N>;

/// Returns the status of a row a (n): invalid_input for a number out of range, infeasible for a row
/// of zeros with b > 0, else optimal. A row of zeros has no length to compare b with, so any b > 0
/// is infeasible. `square`: a . a.
inline SolveStatus row_status(const double* a, Eigen::Index n, double square, double b) noexcept {
  if (square >= smallest * smallest && square <= largest * largest && std::abs(b) <= largest)
      [[likely]] {
    return SolveStatus::optimal;
  }
  const bool zero = std::all_of(a, a + n, [](double x) { return x == 0; });
  if (!zero || !(std::abs(b) <= largest)) return SolveStatus::invalid_input;
  return b > 0 ? SolveStatus::infeasible : SolveStatus::optimal;
}

/// Memory for the rows of a problem with any number of variables.
struct RowStore {
  void reserve(int variables, int rows) {
    const auto count = static_cast<std::size_t>(rows);
    written.resize(count * static_cast<std::size_t>(variables));
    squares.resize(count);
    planes.reserve(count);
  }

  std::vector<double> written;  // rows that come from planes, n^T J
  std::vector<double> squares;  // of the norms
  UnitPlanes planes;            // to find the plane that is violated most
};

/// The constraints A u >= b, and the squared norm of each row of A.
///
/// Rows of planes are scanned as planes: their violations are measured at the tip, J u, and only
/// rows that enter are written out. This requires that the joints can move the tip well in every
/// direction. Rows that bound one variable are scanned as bounds; the results are those of the
/// rows, bit for bit.
template <int N>
class Rows {
 public:
  void reserve(RowStore& store) { store_ = &store; }

  /// Reads the rows. Any status other than `optimal` ends the solve: see row_status.
  SolveStatus read(const StepProblem& problem) noexcept {
    problem_ = &problem;
    planes_ = static_cast<int>(problem.planes.size());
    size_ = static_cast<int>(problem.rows.rows());
    variables_ = static_cast<int>(problem.jacobian.cols());
    first_read_ = planes_ > 0 && list_planes() ? planes_ : 0;
    for (int i = 0; i < planes_ && first_read_ == 0; ++i) write(i);
    SolveStatus status = SolveStatus::optimal;
    first_bound_ = size_ - static_cast<int>(problem.box.size());
    for (int i = first_bound_; i < size_; ++i) {
      squares()[i] = 1;
      if (!(std::abs(bound(i)) <= largest)) return SolveStatus::invalid_input;
    }
    for (int i = first_read_; i < first_bound_; ++i) {
      const double square = dot((*this)[i], (*this)[i]);
      squares()[i] = square;
      const SolveStatus its = row_status((*this)[i], n(), square, bound(i));
      if (its == SolveStatus::invalid_input) return its;
      if (its != SolveStatus::optimal) status = its;
    }
    return status;
  }

  /// Returns the row that is violated most, in units of u, if by more than the tolerance; the
  /// lowest of equals. Compares squares, because a root and a division for each row would take most
  /// of the time. Among the planes, takes the one that the tip violates most.
  int most_violated(const Vector<N>& u, double tolerance) noexcept {
    int worst = no_row;
    double worst_square = tolerance * tolerance;
    if (first_read_ > 0) worst = most_violated_plane(u, tolerance, worst_square);
    for (int i = first_read_; i < first_bound_; ++i) {
      const double missing = violation(i, u);
      if (missing > 0 && missing * missing > worst_square * squares()[i]) [[unlikely]] {
        worst = i;
        worst_square = missing * missing / squares()[i];
      }
    }
    const std::uint8_t* box = problem_->box.data();
    const double* bounds = problem_->bounds.data();
    for (int i = first_bound_; i < size_; ++i) {
      const int number = box[i - first_bound_];
      const double missing = bounds[i] - (number % 2 == 0 ? u[number / 2] : -u[number / 2]);
      if (missing > 0 && missing * missing > worst_square) [[unlikely]] {
        worst = i;
        worst_square = missing * missing;
      }
    }
    return worst;
  }

  const double* operator[](int row) const noexcept {
    const double* rows = row < planes_ ? store_->written.data() : problem_->rows.data();
    return rows + static_cast<std::ptrdiff_t>(row) * n();
  }
  double bound(int row) const noexcept {
    return row < planes_ ? problem_->planes[static_cast<std::size_t>(row)].offset
                         : problem_->bounds[row];
  }
  double norm(int row) const noexcept { return std::sqrt(squares()[row]); }
  double violation(int row, const Vector<N>& u) const noexcept {
    return bound(row) - dot((*this)[row], u.data());
  }

 private:
  int n() const noexcept { return N == Eigen::Dynamic ? variables_ : N; }
  double* squares() const noexcept { return store_->squares.data(); }

  double dot(const double* a, const double* b) const noexcept {
    double sum = 0;
    for (int j = 0; j < n(); ++j) sum += a[j] * b[j];
    return sum;
  }

  void write(int row) noexcept {
    write_row(problem_->planes[static_cast<std::size_t>(row)].normal, problem_->jacobian.data(),
              n(), store_->written.data() + static_cast<std::ptrdiff_t>(row) * n());
  }

  /// Returns false if the planes must be scanned as rows.
  bool list_planes() noexcept {
    if (!measure_jacobian()) return false;
    const bool usable = store_->planes.assign(problem_->planes);
    store_->planes.close();
    return usable;
  }

  /// Computes a lower bound `shortest_` of |n^T J| for unit vectors n. It is the root of the
  /// smallest eigenvalue of J J^T, whose other two eigenvalues have a product of at most (trace /
  /// 2)^2. Returns false if the Jacobian is so uneven that rounding at the tip matters for a row.
  bool measure_jacobian() noexcept {
    double g[6] = {};  // J J^T: xx, yy, zz, xy, xz, yz
    const double* j = problem_->jacobian.data();
    for (int c = 0; c < n(); ++c, j += 3) {
      g[0] += j[0] * j[0];
      g[1] += j[1] * j[1];
      g[2] += j[2] * j[2];
      g[3] += j[0] * j[1];
      g[4] += j[0] * j[2];
      g[5] += j[1] * j[2];
    }
    const double trace = g[0] + g[1] + g[2];
    const double determinant = g[0] * (g[1] * g[2] - g[5] * g[5]) -
                               g[3] * (g[3] * g[2] - g[5] * g[4]) +
                               g[4] * (g[3] * g[5] - g[1] * g[4]);
    const double least = 4 * determinant / (trace * trace);
    shortest_ = std::sqrt(std::max(least, 0.0));
    size_of_jacobian_ = std::sqrt(trace);
    return trace <= largest * largest && least >= trace * (uneven * uneven) &&
           least >= smallest * smallest;
  }

  /// Returns a plane's row only if it is violated beyond the tolerance. The violation at the tip is
  /// less exact than that of the row, so it counts only beyond its rounding.
  int most_violated_plane(const Vector<N>& u, double tolerance, double& worst_square) noexcept {
    double tip[3] = {};
    double length2 = 0;
    const double* j = problem_->jacobian.data();
    for (int c = 0; c < n(); ++c, j += 3) {
      for (int i = 0; i < 3; ++i) tip[i] += j[i] * u[c];
      length2 += u[c] * u[c];
    }
    const Violated worst = store_->planes.most_violated(tip);
    const double noise = 4 * (n() + 8) * epsilon * size_of_jacobian_ * std::sqrt(length2);
    if (!(worst.by > tolerance * shortest_ + noise)) return no_row;
    write(worst.row);
    squares()[worst.row] = dot((*this)[worst.row], (*this)[worst.row]);
    const double missing = violation(worst.row, u);
    if (!(missing > 0)) return no_row;
    worst_square = missing * missing / squares()[worst.row];
    return worst.row;
  }

  const StepProblem* problem_ = nullptr;
  RowStore* store_ = nullptr;
  int planes_ = 0;       // the first rows
  int first_read_ = 0;   // the first row that is scanned one by one
  int first_bound_ = 0;  // the first row of the box, which are the last rows
  int size_ = 0;
  int variables_ = 0;
  double shortest_ = 0;          // lower bound of |n^T J|
  double size_of_jacobian_ = 0;  // Frobenius norm
};

}  // namespace keepout::active_set
