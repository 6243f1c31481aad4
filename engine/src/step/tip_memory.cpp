// SPDX-License-Identifier: BSD-3-Clause
#include "tip_memory.h"

#include <algorithm>
#include <array>
#include <utility>

namespace keepout {
namespace {

// The Jacobian of a tip without joints.
constexpr std::array<double, 9> identity{1, 0, 0, 0, 1, 0, 0, 0, 1};

// The most planes of a triangle: of the contact, of the face, and around each edge.
constexpr std::size_t most_alternatives = 5;

std::size_t most_rows(const Capacity& capacity) {
  return capacity.planes + TipGuides::most_planes + capacity.extra_rows;
}

}  // namespace

TipMemory::TipMemory(const Capacity& capacity, const Solver& solver)
    : planes(capacity.planes),
      earlier_planes(capacity.planes),
      alternatives(most_alternatives),
      branches(most_alternatives * capacity.nodes + 1),
      variables_(static_cast<Eigen::Index>(std::max<std::size_t>(capacity.variables, 3))),
      extra_rows_(static_cast<Eigen::Index>(capacity.extra_rows)),
      writes_planes_(!solver.reads_planes()),
      jacobian_(3 * static_cast<std::size_t>(variables_)),
      rows_(most_rows(capacity) * static_cast<std::size_t>(variables_)),
      bounds_(most_rows(capacity)),
      joined_planes_(capacity.planes + TipGuides::most_planes),
      result_{Buffer<double>(static_cast<std::size_t>(variables_)),
              Buffer<std::uint32_t>(most_rows(capacity))},
      earlier_result_(result_) {}

bool TipMemory::has_room_for(const Motion& request) const noexcept {
  return (!request.jacobian || request.jacobian->joints() <= variables_) &&
         (!request.rows || request.rows->count() <= extra_rows_);
}

StepProblem TipMemory::program_for(const Motion& request, const Vec3& target,
                                   double damping) noexcept {
  const Eigen::Index n = request.jacobian ? request.jacobian->joints() : 3;
  const double* jacobian = identity.data();
  if (request.jacobian) {
    jacobian = request.jacobian->data();
    if (!request.jacobian->is_packed()) {
      Eigen::Map<TipJacobian::Matrix>(jacobian_.data(), 3, n) = request.jacobian->matrix();
      jacobian = jacobian_.data();
    }
  }
  const std::span<const HalfSpace> half_spaces = solver_planes();
  if (writes_planes_) write_rows_of(half_spaces, request.jacobian ? jacobian : nullptr, n);
  const auto m = static_cast<Eigen::Index>(half_spaces.size());
  const Eigen::Index extra = request.rows ? request.rows->count() : 0;
  if (extra > 0) {
    std::copy_n(request.rows->matrix(), extra * n, rows_.data() + m * n);
    std::copy_n(request.rows->bounds(), extra, bounds_.data() + m);
  }
  target_ = target;
  return {.jacobian = {jacobian, 3, n},
          .desired = {target_.data(), 3},
          .rows = {rows_.data(), m + extra, n},
          .bounds = {bounds_.data(), m + extra},
          .damping = damping,
          .planes = half_spaces};
}

/// Writes the rows of planes: n^T J, or the normals themselves without a Jacobian.
void TipMemory::write_rows_of(std::span<const HalfSpace> half_spaces, const double* jacobian,
                              Eigen::Index variables) noexcept {
  double* row = rows_.data();
  for (std::size_t p = 0; p < half_spaces.size(); ++p, row += variables) {
    if (jacobian != nullptr) {
      write_row(half_spaces[p].normal, jacobian, variables, row);
    } else {
      std::copy_n(half_spaces[p].normal.data(), 3, row);
    }
    bounds_[p] = half_spaces[p].offset;
  }
}

std::span<const HalfSpace> TipMemory::join_guides(std::size_t guide_planes) noexcept {
  joined_planes_.assign(planes.view());
  for (const HalfSpace& plane : guides.planes().first(guide_planes)) joined_planes_.push(plane);
  return joined_planes_.view();
}

void TipMemory::store_result(const Motion& request, const Vec3& tip_motion, double fraction,
                             const Solution& solution, Relaxation relaxation,
                             Limits limits) noexcept {
  result_.guide_planes = guides.planes().size();
  result_.relaxation = relaxation;
  result_.limits = limits;
  result_.increment.clear();
  if (request.jacobian) {
    for (const double u : solution.u) result_.increment.push(fraction * u + 0.0);  // no signed zero
  } else {
    for (const double u : without_signed_zeros(tip_motion)) result_.increment.push(u);
  }
  result_.active.assign(solution.active);
}

void TipMemory::store_zero_result(const Motion& request, Relaxation relaxation,
                                  Limits limits) noexcept {
  store_result(request, Vec3::Zero(), 0.0, {}, relaxation, limits);
  const Eigen::Index joints = request.jacobian ? request.jacobian->joints() : 0;
  for (Eigen::Index k = 0; k < joints; ++k) result_.increment.push(0.0);
}

void TipMemory::swap_with_earlier() noexcept {
  std::swap(planes, earlier_planes);
  std::swap(result_, earlier_result_);
}

}  // namespace keepout
