// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/judged_guide.h"

#include <algorithm>

namespace keepout::oracle {
namespace {

using Real = LinkFrame::Real;
using Vector = Eigen::Matrix<Real, 3, 1>;

Vector at(const JudgedPoint& point, std::span<const LinkFrame> links) {
  const LinkFrame& link = links[static_cast<std::size_t>(point.link)];
  return link.origin + link.axes * point.position.cast<Real>();
}

Vector guided(const JudgedGuide& guide, std::span<const LinkFrame> links) {
  if (guide.kind == JudgedGuide::Kind::axis) {
    return links[static_cast<std::size_t>(guide.first.link)].axes *
           guide.first.position.cast<Real>();
  }
  const Vector from = at(guide.first, links);
  if (guide.kind == JudgedGuide::Kind::point) return from;
  const Vector along = at(guide.second, links) - from;
  const Real squared = along.squaredNorm();
  if (!(squared > 0)) return from;
  const Real share = along.dot(guide.origin.cast<Real>() - from) / squared;
  return from + std::clamp(share, Real{0}, Real{1}) * along;
}

}  // namespace

double excess(const JudgedGuide& guide, std::span<const LinkFrame> links) {
  const Vector offset = guided(guide, links) - guide.origin.cast<Real>();
  const Vector direction = guide.direction.cast<Real>();
  const Real along = offset.dot(direction);
  Real out = 0;
  switch (guide.region) {
    case JudgedGuide::Region::half_space:
      out = -along;
      break;
    case JudgedGuide::Region::slab:
      out = along < 0 ? -along : along;
      break;
    case JudgedGuide::Region::tube:
      out = (offset - along * direction).norm();
      break;
    case JudgedGuide::Region::ball:
      out = offset.norm();
      break;
  }
  return static_cast<double>(out - guide.radius);
}

}  // namespace keepout::oracle
