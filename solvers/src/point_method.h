// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>

#include "keepout/geometry/shapes.h"
#include "keepout/step/solver.h"
#include "unit_planes.h"

namespace keepout::active_set {

/// The dual method for three variables with J = I and no damping. It finds the point nearest to d
/// that satisfies every row. The parts of a row have a closed form, by cross products, and at most
/// three rows are active.
///
/// The answer proves itself. By construction u is d + sum mu_i a_i with mu >= 0. It is returned
/// only if the active rows hold with equality and no row is violated. Together these prove that it
/// is the minimum. Problems without such a proof, such as infeasible ones, go to the general
/// method.
class PointMethod {
 public:
  void reserve(int rows) { unit_.reserve(static_cast<std::size_t>(rows)); }

  /// Returns true if the minimum is found. Precondition: moves_a_point(problem), and the shapes
  /// agree and fit the reserve.
  bool solve(const StepProblem& problem) noexcept;

  const Vec3& u() const noexcept { return u_; }
  int active_count() const noexcept { return active_; }
  int row(int i) const noexcept { return active_rows_[at(i)].row; }
  double multiplier(int i) const noexcept { return active_rows_[at(i)].mu; }
  int iterations() const noexcept { return iterations_; }

 private:
  struct ActiveRow {
    Vec3 normal;
    double square;  // of the normal
    double bound;
    double mu;  // multiplier of half the cost; a Solution has twice this
    int row;
  };

  /// A row as a sum of the active rows and a rest that is normal to them.
  struct Split {
    std::array<double, 3> weight{};
    double rest2 = 0;  // |rest|^2
  };

  /// Returns the number of an active row as an array index.
  static std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

  bool list_rows(const StepProblem& problem) noexcept;
  template <class Scan>
  bool run(const StepProblem& problem, const Scan& scan) noexcept;
  void take_in(const StepProblem& problem, int row) noexcept;
  bool enter() noexcept;
  Split split() const noexcept;
  bool settle() noexcept;
  void correct(const std::array<double, 3>& slack) noexcept;
  void update_u(int rows) noexcept;
  void drop(int position) noexcept;

  UnitPlanes unit_;
  Vec3 desired_ = Vec3::Zero();
  Vec3 u_ = Vec3::Zero();
  double asked2_ = 0;                       // |d|^2
  std::array<ActiveRow, 4> active_rows_{};  // the active rows, then the entering one
  int active_ = 0;
  int iterations_ = 0;
};

}  // namespace keepout::active_set
