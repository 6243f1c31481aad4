// SPDX-License-Identifier: BSD-3-Clause
#include "joint_task.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace keepout {
namespace {

double length_of(const std::array<double, JointTask::most_equations>& v) noexcept {
  return Eigen::Map<const Eigen::Vector<double, JointTask::most_equations>>(v.data()).norm();
}

}  // namespace

double JointTask::cost(const JointVector& increment) const noexcept {
  const auto n = static_cast<std::size_t>(joints);
  JointVector u;
  for (int k = 0; k < joints; ++k) u[static_cast<std::size_t>(k)] = in_units(increment, k);
  double sum = 0.0;
  for (std::size_t row = 0; row < static_cast<std::size_t>(equations); ++row) {
    double off = -desired[row];
    for (std::size_t k = 0; k < n; ++k) {
      off += jacobian[k * static_cast<std::size_t>(equations) + row] * u[k];
    }
    sum += off * off;
  }
  for (std::size_t k = 0; k < n; ++k) sum += damping * u[k] * u[k];
  return sum;
}

double JointTask::cost_of_share(const JointVector& increment, double fraction) const noexcept {
  JointVector cut = increment;
  for (double& number : cut) number *= fraction;
  return cost(cut);
}

double JointTask::best_share(const JointVector& increment, double most) const noexcept {
  // The cost of a fraction s is square s^2 - 2 gain s + cost(0).
  double square = 0.0;
  double gain = 0.0;
  for (int row = 0; row < equations; ++row) {
    double made = 0.0;
    for (int k = 0; k < joints; ++k) {
      made += jacobian[static_cast<std::size_t>(k * equations + row)] * in_units(increment, k);
    }
    square += made * made;
    gain += made * desired[static_cast<std::size_t>(row)];
  }
  for (int k = 0; k < joints; ++k) {
    const double u = in_units(increment, k);
    square += damping * u * u;
  }
  if (gain >= most * square) return most;
  return std::max(gain / square, 0.0);
}

JointTask JointTask::damped() const noexcept {
  double largest2 = 0.0;  // of the columns of J
  for (int k = 0; k < joints; ++k) {
    double length2 = 0.0;
    for (int row = 0; row < equations; ++row) {
      const double entry = jacobian[static_cast<std::size_t>(k * equations + row)];
      length2 += entry * entry;
    }
    largest2 = std::max(largest2, length2);
  }
  JointTask task = *this;
  task.damping = std::max(16.0 * damping, 1e-6 * largest2);
  return task;
}

double JointTask::linear_miss(const JointVector& increment, double fraction) const noexcept {
  const double square = cost_of_share(increment, fraction) - damping_cost(increment, fraction);
  return std::sqrt(std::max(square, 0.0));
}

double JointTask::true_miss(const Pose& from, const Pose& to) const noexcept {
  const Vec3 displacement = to.position - from.position;
  Vec3 turn = Vec3::Zero();
  if (*orientation_weight > 0.0) {
    const Eigen::AngleAxisd turned(Mat3(to.rotation * from.rotation.transpose()));
    turn = *orientation_weight * turned.angle() * turned.axis();
  }
  double sum = 0.0;
  for (int row = 0; row < equations; ++row) {
    const double made = row < 3 ? displacement[row] : turn[row - 3];
    const double off = made - desired[static_cast<std::size_t>(row)];
    sum += off * off;
  }
  return std::sqrt(sum);
}

double JointTask::damping_cost(const JointVector& increment, double fraction) const noexcept {
  double sum = 0.0;
  for (int k = 0; k < joints; ++k) {
    const double u = fraction * in_units(increment, k);
    sum += damping * u * u;
  }
  return sum;
}

JointTask JointTask::scaled(double fraction) const noexcept {
  JointTask task = *this;
  for (double& number : task.desired) number *= fraction;
  task.miss_at_rest *= fraction;
  return task;
}

JointTask flange_task(const ChainState& chain, const Twist& displacement,
                      const InstrumentOptions& options) noexcept {
  const bool turns = options.orientation_weight > 0.0;
  // The unit of a prismatic joint moves the flange by the length that has the weight of one radian.
  const double length = turns ? options.orientation_weight : 1.0;
  JointTask task{.equations = turns ? 6 : 3,
                 .joints = chain.size(),
                 .damping = options.damping,
                 .orientation_weight = options.orientation_weight};
  const Vec3 tip = chain.flange().position;
  const auto put = [&](double* to, const Vec3& linear, const Vec3& angular) {
    for (int axis = 0; axis < 3; ++axis) {
      to[axis] = linear[axis];
      if (turns) to[3 + axis] = options.orientation_weight * angular[axis];
    }
  };
  put(task.desired.data(), displacement.linear, displacement.angular);
  for (int k = 1; k <= chain.size(); ++k) {
    const double unit = chain.turns(k) ? 1.0 : length;
    task.unit[static_cast<std::size_t>(k - 1)] = unit;
    put(task.jacobian.data() + (k - 1) * task.equations, unit * chain.linear(k, chain.size(), tip),
        chain.angular(k, chain.size()));
  }
  task.miss_at_rest = length_of(task.desired);
  return task;
}

JointTask joint_task(std::span<const double> desired, std::span<const double> weights) noexcept {
  const int n = static_cast<int>(desired.size());
  JointTask task{.equations = n, .joints = n};
  for (std::size_t k = 0; k < desired.size(); ++k) {
    const double weight = weights.empty() ? 1.0 : std::sqrt(weights[k]);
    task.unit[k] = 1.0;
    task.jacobian[k * desired.size() + k] = weight;
    task.desired[k] = weight * desired[k];
  }
  task.miss_at_rest = length_of(task.desired);
  return task;
}

}  // namespace keepout
