// SPDX-License-Identifier: BSD-3-Clause
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "unit_planes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each target.
#include <hwy/highway.h>

#include "unit_planes.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::active_set {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Each lane keeps its largest violation, and its first place as a double, so that one mask chooses
// both. A maximum is exact, and so is the choice of the first among lanes.
Violated most_violated(const double* HWY_RESTRICT x, const double* HWY_RESTRICT y,
                       const double* HWY_RESTRICT z, const double* HWY_RESTRICT offset,
                       std::size_t size, const double* HWY_RESTRICT point) {
  const hn::CappedTag<double, 8> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto px = hn::Set(d, point[0]);
  const auto py = hn::Set(d, point[1]);
  const auto pz = hn::Set(d, point[2]);
  const auto step = hn::Set(d, static_cast<double>(lanes));
  auto at = hn::Iota(d, 0.0);
  auto place = at;
  auto worst = hn::Set(d, -std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < size; i += lanes) {
    const auto xy = hn::Add(hn::Mul(hn::LoadU(d, x + i), px), hn::Mul(hn::LoadU(d, y + i), py));
    const auto along = hn::Add(xy, hn::Mul(hn::LoadU(d, z + i), pz));
    const auto violation = hn::Sub(hn::LoadU(d, offset + i), along);
    place = hn::IfThenElse(hn::Gt(violation, worst), at, place);
    worst = hn::Max(worst, violation);
    at = hn::Add(at, step);
  }
  const auto largest = hn::MaxOfLanes(d, worst);
  const auto nowhere = hn::Set(d, std::numeric_limits<double>::infinity());
  const auto first = hn::MinOfLanes(d, hn::IfThenElse(hn::Eq(worst, largest), place, nowhere));
  return {static_cast<int>(hn::GetLane(first)), hn::GetLane(largest)};
}

}  // namespace HWY_NAMESPACE
}  // namespace keepout::active_set
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace keepout::active_set {

HWY_EXPORT(most_violated);

void UnitPlanes::reserve(std::size_t planes) {
  for (std::vector<double>* list : {&x_, &y_, &z_, &offset_}) list->resize(planes + most_lanes);
  size_ = 0;
}

void UnitPlanes::close() noexcept {
  const std::size_t used = size_;
  // The last vector is filled with planes that no point violates.
  constexpr double zero[3] = {};
  while (size_ % most_lanes != 0) push(zero, -std::numeric_limits<double>::infinity());
  size_ = used;
}

Violated UnitPlanes::most_violated(const double* point) const noexcept {
  if (size_ == 0) return {};
  const std::size_t whole = (size_ + most_lanes - 1) / most_lanes * most_lanes;
  return HWY_DYNAMIC_DISPATCH(most_violated)(x_.data(), y_.data(), z_.data(), offset_.data(), whole,
                                             point);
}

}  // namespace keepout::active_set
#endif
