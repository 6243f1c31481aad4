// SPDX-License-Identifier: BSD-3-Clause
#include "branches.h"

#include <algorithm>

namespace keepout {

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

}  // namespace keepout
