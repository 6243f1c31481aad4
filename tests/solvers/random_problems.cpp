// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/random_problems.h"

#include <Eigen/QR>
#include <algorithm>

namespace keepout::test {
namespace {

StepProblem::Matrix orthogonal(int n, Random& random) {
  return Eigen::HouseholderQR<StepProblem::Matrix>(random.matrix(n, n)).householderQ();
}

StepProblem::Matrix well_conditioned(int k, int n, Random& random) {
  StepProblem::Matrix m = random.matrix(k, n);
  m.topLeftCorner(n, n).diagonal().array() += 4.0;
  return m;
}

/// Returns values from 1 down to 1e-6.
Eigen::VectorXd spread(int n) {
  Eigen::VectorXd v(n);
  for (int i = 0; i < n; ++i) v[i] = n == 1 ? 1.0 : std::pow(10.0, -6.0 * i / (n - 1));
  return v;
}

}  // namespace

void make_task(Problem& problem, Task task, int n, Random& random) {
  problem.damping = 0;
  switch (task) {
    case Task::identity:
      problem.jacobian = StepProblem::Matrix::Identity(n, n);
      break;
    case Task::damped_identity:
      problem.jacobian = StepProblem::Matrix::Identity(n, n);
      problem.damping = random.log_uniform(1e-6, 1e2);
      break;
    case Task::square:
      problem.jacobian = well_conditioned(n, n, random);
      break;
    case Task::tall:
      problem.jacobian = well_conditioned(n + random.integer(1, 20), n, random);
      break;
    case Task::wide_damped:
      problem.jacobian = random.matrix(random.integer(0, n - 1), n);
      problem.damping = random.log_uniform(1e-4, 1);
      break;
    case Task::slanted:
      problem.jacobian =
          orthogonal(n, random) * spread(n).asDiagonal() * orthogonal(n, random).transpose();
      break;
    case Task::uneven_columns:
      problem.jacobian = well_conditioned(n, n, random) * spread(n).asDiagonal();
      break;
  }
  problem.desired = random.vector(problem.jacobian.rows());
}

void make_planes(Problem& problem, Planes planes, const Eigen::VectorXd& inside, int m,
                 Random& random) {
  const Eigen::Index n = inside.size();
  problem.rows.resize(m, n);
  problem.bounds.resize(m);
  double tilt = 0;
  double width = 0;
  for (int i = 0; i < m; ++i) {
    const bool again = i > 0 && i % 2 == 1;
    Eigen::VectorXd row = random.direction(n);
    double slack = random.uniform(0, 1);
    double scale = 1;
    switch (planes) {
      case Planes::scattered:
        break;
      case Planes::touching:
        if (again) slack = 0;
        break;
      case Planes::duplicated:
        if (again) {
          scale = i % 4 == 1 ? 1.0 : random.log_uniform(0.1, 10);
          problem.rows.row(i) = scale * problem.rows.row(i - 1);
          problem.bounds[i] = scale * problem.bounds[i - 1];
          continue;
        }
        break;
      case Planes::redundant:
        if (again) {
          problem.rows.row(i) = problem.rows.row(i - 1);
          problem.bounds[i] = problem.bounds[i - 1] - random.log_uniform(1e-15, 1);
          continue;
        }
        break;
      case Planes::uneven:
        scale = random.log_uniform(1e-6, 1e6);
        break;
      case Planes::vertex:
        slack = 0;
        break;
      case Planes::near_parallel:
        if (i % 4 == 0) tilt = random.log_uniform(1e-12, 1e-4);
        if (i % 4 != 0) {
          row = (problem.rows.row(i - 1).transpose() + tilt * random.direction(n)).normalized();
          slack = tilt * random.uniform(0, 1);
        }
        break;
      case Planes::slabs:
        width = again && i % 4 == 3 ? random.log_uniform(1e-18, 1e-9) : 0;
        if (again) {
          problem.rows.row(i) = -problem.rows.row(i - 1);
          problem.bounds[i] = -problem.bounds[i - 1] - width;
          continue;
        }
        slack = 0;
        break;
      case Planes::lattice:
        do {
          for (double& x : row) x = random.integer(-1, 1);
        } while (row.isZero());
        problem.rows.row(i) = row;
        problem.bounds[i] = row.dot(inside.array().round().matrix()) - random.integer(0, 1);
        continue;
    }
    problem.rows.row(i) = scale * row;
    problem.bounds[i] = problem.rows.row(i).dot(inside) - scale * slack;
  }
}

void make_mixed_planes(Problem& problem, const Eigen::VectorXd& inside, Random& random) {
  problem.rows.resize(0, inside.size());
  problem.bounds.resize(0);
  for (int part = 0; part < 4; ++part) {
    Problem more;
    const auto kind = static_cast<std::size_t>(random.integer(0, 7));
    make_planes(more, plane_kinds[kind], inside, random.integer(0, 20), random);
    const Eigen::Index before = problem.rows.rows();
    const Eigen::Index count = more.rows.rows();
    problem.rows.conservativeResize(before + count, inside.size());
    problem.bounds.conservativeResize(before + count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double scale = random.log_uniform(1e-3, 1e3);
      problem.rows.row(before + i) = scale * more.rows.row(i);
      problem.bounds[before + i] = scale * more.bounds[i];
    }
  }
}

void make_infeasible(Problem& problem, double margin, Random& random, Weights weights) {
  const Eigen::Index n = problem.rows.cols();
  const Eigen::Index m = problem.rows.rows();
  const Eigen::Index count = std::min<Eigen::Index>(random.integer(2, static_cast<int>(n) + 1), m);
  const Eigen::Index first = random.integer(0, static_cast<int>(m - count));
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n);
  double bound = 0;
  for (Eigen::Index i = first; i + 1 < first + count; ++i) {
    const double norm = weights == Weights::even ? problem.rows.row(i).norm() : 1;
    const double weight = random.uniform(0.2, 2) / norm;
    sum += weight * problem.rows.row(i).transpose();
    bound += weight * problem.bounds[i];
  }
  problem.rows.row(first + count - 1) = -sum;
  problem.bounds[first + count - 1] = margin * sum.norm() - bound;
}

}  // namespace keepout::test
