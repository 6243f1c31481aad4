// SPDX-License-Identifier: BSD-3-Clause
#include "workspace.h"

#include <algorithm>
#include <array>
#include <utility>

namespace keepout {
namespace {

// What the tip's increment is to itself.
constexpr std::array<double, 9> identity{1, 0, 0, 0, 1, 0, 0, 0, 1};

// Ways around one triangle: the plane of the contact, of the face, and of each edge.
constexpr std::size_t most_ways = 5;

std::size_t most_rows(const Capacity& capacity) {
  return capacity.planes + TipGuides::most_planes + capacity.extra_rows;
}

}  // namespace

void Branches::push(double cost, const Vec3& motion, std::span<const HalfSpace> planes) noexcept {
  if (size_ == branches_.size() || planes.size() > Branch::most_planes) return;
  Branch& branch = branches_[size_++];
  branch.cost = cost;
  branch.motion = motion;
  std::copy(planes.begin(), planes.end(), branch.planes_.begin());
  branch.count_ = planes.size();
  branch.open_ = true;
}

const Branch* Branches::pop_nearest() noexcept {
  Branch* nearest = nullptr;
  for (std::size_t i = 0; i < size_; ++i) {
    Branch& branch = branches_[i];
    if (branch.open_ && (nearest == nullptr || branch.cost < nearest->cost)) nearest = &branch;
  }
  if (nearest != nullptr) nearest->open_ = false;
  return nearest;
}

Workspace::Workspace(const Capacity& capacity, const Solver& solver)
    : planes(capacity.planes),
      earlier_planes(capacity.planes),
      ways(most_ways),
      branches(most_ways * capacity.nodes + 1),
      variables_(static_cast<Eigen::Index>(std::max<std::size_t>(capacity.variables, 3))),
      extra_rows_(static_cast<Eigen::Index>(capacity.extra_rows)),
      writes_planes_(!solver.reads_planes()),
      jacobian_(3 * static_cast<std::size_t>(variables_)),
      rows_(most_rows(capacity) * static_cast<std::size_t>(variables_)),
      bounds_(most_rows(capacity)),
      posed_(capacity.planes + TipGuides::most_planes),
      result_{Buffer<double>(static_cast<std::size_t>(variables_)),
              Buffer<std::uint32_t>(most_rows(capacity))},
      earlier_result_(result_) {}

bool Workspace::has_room_for(const Motion& motion) const noexcept {
  return (!motion.jacobian || motion.jacobian->joints() <= variables_) &&
         (!motion.rows || motion.rows->count() <= extra_rows_);
}

StepProblem Workspace::pose(const Motion& motion, const Vec3& target, double damping) noexcept {
  const Eigen::Index n = motion.jacobian ? motion.jacobian->joints() : 3;
  const double* jacobian = identity.data();
  if (motion.jacobian) {
    jacobian = motion.jacobian->data();
    if (!motion.jacobian->is_packed()) {
      Eigen::Map<TipJacobian::Matrix>(jacobian_.data(), 3, n) = motion.jacobian->matrix();
      jacobian = jacobian_.data();
    }
  }
  const std::span<const HalfSpace> half_spaces = posed();
  if (writes_planes_) write_rows_of(half_spaces, motion.jacobian ? jacobian : nullptr, n);
  const auto m = static_cast<Eigen::Index>(half_spaces.size());
  const Eigen::Index extra = motion.rows ? motion.rows->count() : 0;
  if (extra > 0) {
    std::copy_n(motion.rows->matrix(), extra * n, rows_.data() + m * n);
    std::copy_n(motion.rows->bounds(), extra, bounds_.data() + m);
  }
  desired_ = target;
  return {.jacobian = {jacobian, 3, n},
          .desired = {desired_.data(), 3},
          .rows = {rows_.data(), m + extra, n},
          .bounds = {bounds_.data(), m + extra},
          .damping = damping,
          .planes = half_spaces};
}

/// Without a Jacobian they are the normals themselves.
void Workspace::write_rows_of(std::span<const HalfSpace> posed, const double* jacobian,
                              Eigen::Index variables) noexcept {
  double* row = rows_.data();
  for (std::size_t p = 0; p < posed.size(); ++p, row += variables) {
    if (jacobian != nullptr) {
      write_row(posed[p].normal, jacobian, variables, row);
    } else {
      std::copy_n(posed[p].normal.data(), 3, row);
    }
    bounds_[p] = posed[p].offset;
  }
}

std::span<const HalfSpace> Workspace::joined(std::size_t guide_planes) noexcept {
  posed_.assign(planes.view());
  for (const HalfSpace& plane : guides.planes().first(guide_planes)) posed_.push(plane);
  return posed_.view();
}

void Workspace::store_result(const Motion& motion, const Vec3& tip_motion, double share,
                             Relaxation relaxation, Limits limits) noexcept {
  result_.guide_planes = guides.planes().size();
  result_.relaxation = relaxation;
  result_.limits = limits;
  result_.increment.clear();
  // The sum with 0 takes the sign off a zero, which else that of some zero in the input decides.
  if (motion.jacobian) {
    for (const double u : solution.u) result_.increment.push(share * u + 0.0);
  } else {
    for (const double u : tip_motion) result_.increment.push(u + 0.0);
  }
  result_.active.assign(solution.active);
}

void Workspace::store_zero_result(const Motion& motion, Relaxation relaxation,
                                  Limits limits) noexcept {
  solution = {};
  store_result(motion, Vec3::Zero(), 0.0, relaxation, limits);
  const Eigen::Index joints = motion.jacobian ? motion.jacobian->joints() : 0;
  for (Eigen::Index k = 0; k < joints; ++k) result_.increment.push(0.0);
}

void Workspace::save() noexcept {
  restore();
  planes.clear();
}

void Workspace::restore() noexcept {
  std::swap(planes, earlier_planes);
  std::swap(result_, earlier_result_);
}

}  // namespace keepout
