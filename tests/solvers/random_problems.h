// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string_view>

#include "keepout/step/solver.h"

namespace keepout::test {

/// A step problem that owns its numbers.
struct Problem {
  StepProblem::Matrix jacobian;
  StepProblem::Vector desired;
  StepProblem::RowMatrix rows;
  StepProblem::Vector bounds;
  double damping = 0;

  StepProblem view() const {
    return {.jacobian = {jacobian.data(), jacobian.rows(), jacobian.cols()},
            .desired = {desired.data(), desired.size()},
            .rows = {rows.data(), rows.rows(), rows.cols()},
            .bounds = {bounds.data(), bounds.size()},
            .damping = damping};
  }
};

/// The kind of a problem's task.
enum class Task { identity, damped_identity, square, tall, wide_damped, slanted, uneven_columns };
inline constexpr std::array tasks = {Task::identity,      Task::damped_identity, Task::square,
                                     Task::tall,          Task::wide_damped,     Task::slanted,
                                     Task::uneven_columns};

/// The kind of a problem's constraints. All have a feasible point by construction.
enum class Planes {
  scattered,      // the feasible point is inside
  touching,       // half of the planes pass through the feasible point
  duplicated,     // each plane twice, some copies scaled
  redundant,      // each plane twice, one farther out
  uneven,         // row norms from 1e-6 to 1e6
  vertex,         // all planes pass through the feasible point
  near_parallel,  // in bundles, 1e-12 to 1e-4 rad apart
  slabs,          // in opposite pairs, 0 to 1e-9 apart
  lattice         // whole numbers: exact ties and exact dependence throughout
};
inline constexpr std::array plane_kinds = {
    Planes::scattered, Planes::touching,      Planes::duplicated, Planes::redundant, Planes::uneven,
    Planes::vertex,    Planes::near_parallel, Planes::slabs,      Planes::lattice};

inline std::string_view name(Task task) {
  constexpr std::array names = {"identity", "damped identity", "square",        "tall",
                                "wide",     "slanted (1e6)",   "uneven columns"};
  return names[static_cast<std::size_t>(task)];
}

inline std::string_view name(Planes planes) {
  constexpr std::array names = {"scattered", "touching",      "duplicated", "redundant", "uneven",
                                "vertex",    "near parallel", "slabs",      "lattice"};
  return names[static_cast<std::size_t>(planes)];
}

/// Seeded, so that the problem of a failure can be made again.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high) { return low + (high - low) * unit(); }
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  int integer(int low, int high) {  // bounds included
    return low + static_cast<int>(unit() * (high - low + 1));
  }
  /// Returns a roughly normal number: std::normal_distribution differs between libraries.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += unit();
    return sum;
  }
  Eigen::VectorXd vector(Eigen::Index size) {
    Eigen::VectorXd v(size);
    for (double& x : v) x = normal();
    return v;
  }
  Eigen::VectorXd direction(Eigen::Index size) {
    for (;;) {
      const Eigen::VectorXd v = vector(size);
      if (v.norm() > 0.1) return v.normalized();
    }
  }
  StepProblem::Matrix matrix(Eigen::Index rows, Eigen::Index columns) {
    StepProblem::Matrix m(rows, columns);
    for (Eigen::Index j = 0; j < columns; ++j) m.col(j) = vector(rows);
    return m;
  }

 private:
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  std::mt19937_64 engine_;
};

/// Sets J, d and damping for n variables. Random square matrices may be almost singular by chance.
/// A multiple of the identity prevents this, so that the classes remain distinct.
void make_task(Problem& problem, Task task, int n, Random& random);

/// Sets rows and bounds for n variables such that `inside` satisfies them up to rounding.
void make_planes(Problem& problem, Planes planes, const Eigen::VectorXd& inside, int m,
                 Random& random);

/// Sets four groups of planes around one point, of random kinds, with rows scaled by 1e-3 to 1e3.
void make_mixed_planes(Problem& problem, const Eigen::VectorXd& inside, Random& random);

/// The rows that the weights of make_infeasible apply to: unit rows, or the rows with their norms.
enum class Weights { even, as_they_are };

/// Replaces a row so that it and some others, with weights of order 1, add up to 0 u >= margin > 0:
/// a certificate of infeasibility (Farkas).
void make_infeasible(Problem& problem, double margin, Random& random,
                     Weights weights = Weights::even);

}  // namespace keepout::test
