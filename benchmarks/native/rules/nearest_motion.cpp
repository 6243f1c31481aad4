// SPDX-License-Identifier: BSD-3-Clause
#include "nearest_motion.h"

#include <algorithm>

namespace keepout::peers {

void NearestMotion::begin(const std::optional<Corridor>& corridor, const Vec3& tip) {
  planes_.clear();
  if (!corridor) return;
  const double beside = corridor->normal.dot(tip - corridor->point);
  add(corridor->normal, std::min(0.0, -corridor->half_width - beside));
  add(-corridor->normal, std::min(0.0, beside - corridor->half_width));
}

Vec3 NearestMotion::to(const Vec3& desired) {
  const auto is_violated = [&](const HalfSpace& p) { return p.normal.dot(desired) < p.offset; };
  if (std::none_of(planes_.begin(), planes_.end(), is_violated)) return desired;
  if (planes_.size() == 1) {
    const HalfSpace& plane = planes_.front();
    return desired + (plane.offset - plane.normal.dot(desired)) * plane.normal;
  }
  const int count = static_cast<int>(planes_.size());
  if (count > capacity_) solver_.reserve(3, capacity_ = 2 * count);
  rows_.clear();
  bounds_.clear();
  for (const HalfSpace& plane : planes_) {
    rows_.insert(rows_.end(), plane.normal.begin(), plane.normal.end());
    bounds_.push_back(plane.offset);
  }
  static constexpr std::array<double, 9> identity{1, 0, 0, 0, 1, 0, 0, 0, 1};
  const StepProblem problem{{identity.data(), 3, 3},
                            {desired.data(), 3},
                            {rows_.data(), count, 3},
                            {bounds_.data(), count},
                            0.0,
                            planes_};
  Solution solution;
  if (solver_.solve(problem, solution) != SolveStatus::optimal) return Vec3::Zero();
  return {solution.u[0], solution.u[1], solution.u[2]};
}

}  // namespace keepout::peers
