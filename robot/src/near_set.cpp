// SPDX-License-Identifier: BSD-3-Clause
#include "near_set.h"

#include <algorithm>
#include <limits>

namespace keepout {
namespace {

constexpr double far = std::numeric_limits<double>::infinity();

double inverse_square(const Vec3& v) noexcept {
  const double length2 = v.squaredNorm();
  return length2 > 0.0 ? 1.0 / length2 : 0.0;
}

/// A lower bound of the distance from a segment to a triangle, by the plane across the shortest way
/// to the triangle's middle.
double least_distance(const Vec3& a, const Vec3& along, double inverse2,
                      const Triangle& corners) noexcept {
  const Vec3 middle = (corners[0] + corners[1] + corners[2]) * (1.0 / 3.0);
  const double share = std::clamp(along.dot(middle - a) * inverse2, 0.0, 1.0);
  const Vec3 nearest = a + share * along;
  const Vec3 towards = middle - nearest;
  const double length2 = towards.squaredNorm();
  if (!(length2 > 0.0)) return 0.0;
  const double along_least =
      std::min({towards.dot(corners[0] - nearest), towards.dot(corners[1] - nearest),
                towards.dot(corners[2] - nearest)});
  return along_least > 0.0 ? along_least / std::sqrt(length2) : 0.0;
}

}  // namespace

NearSet::NearSet(std::size_t room) : room_(room) {
  ids_.reserve(room);
  corners_.reserve(room);
  least_.reserve(room);
  least_of_block_.reserve(room / block + 1);
  told_.reserve(room);
  core_.reserve(64);
}

bool NearSet::look(Neighborhood& near, std::span<const Vec3> core, double beyond, double radius,
                   double close, double tolerance) noexcept {
  forget();
  core_.assign(core.begin(), core.end());
  ids_.clear();
  corners_.clear();
  least_.clear();
  least_of_block_.clear();
  const Vec3& a = core.front();
  const Vec3& b = core.size() > 1 ? core[1] : a;
  TriangleBuffer& candidates = near.candidates();
  candidates.clear();
  near.index().collect_near({a, b, radius + beyond + tolerance}, candidates);
  near.budget().spend(16 + candidates.size());
  if (candidates.overflowed() || near.budget().is_spent()) return false;
  const Mesh& mesh = near.mesh();
  const Vec3 along = b - a;
  const double inverse2 = inverse_square(along);
  double least_of_block = far;
  for (const TriangleId id : candidates) {
    const Triangle corners = mesh.triangle(id);
    double least = least_distance(a, along, inverse2, corners) - beyond - tolerance;
    if (least > radius) continue;
    if (least < close) {
      near.budget().spend(3);
      least = gap(core, corners).distance - tolerance;
      if (least > radius) continue;
    }
    if (ids_.size() == room_) return false;
    ids_.push_back(id);
    corners_.push_back(corners);
    least_.push_back(least);
    least_of_block = std::min(least_of_block, least);
    if (ids_.size() % block != 0) continue;
    least_of_block_.push_back(least_of_block);
    least_of_block = far;
  }
  if (ids_.size() % block != 0) least_of_block_.push_back(least_of_block);
  if (near.budget().is_spent()) return false;
  radius_ = radius;
  beyond_ = beyond;
  tolerance_ = tolerance;
  start_cycle(core, 0.0);
  return true;
}

void NearSet::start_cycle(std::span<const Vec3> core, double moved) noexcept {
  first_ = core.front();
  along_ = core.size() > 1 ? Vec3(core[1] - first_) : Vec3::Zero();
  moved_ = moved;
  told_.clear();
  told_below_ = -far;
}

std::span<NearTriangle> NearSet::nearer_than(double distance) noexcept {
  if (distance > told_below_) {
    const auto known = static_cast<std::ptrdiff_t>(told_.size());
    const double inverse2 = inverse_square(along_);
    const double then = distance + moved_;
    for (std::size_t of = 0; of < least_of_block_.size(); ++of) {
      if (!(least_of_block_[of] < then)) continue;
      const std::size_t end = std::min((of + 1) * block, ids_.size());
      for (std::size_t i = of * block; i < end; ++i) {
        if (!(least_[i] < then)) continue;
        const double now = least_distance(first_, along_, inverse2, corners_[i]);
        const double least = std::max(least_[i] - moved_, now - beyond_ - tolerance_);
        if (!(least < distance) || least < told_below_) continue;
        told_.push_back({.id = ids_[i], .least = least, .corners = &corners_[i]});
      }
    }
    std::sort(told_.begin() + known, told_.end(), [](const NearTriangle& x, const NearTriangle& y) {
      return x.least < y.least || (x.least == y.least && x.id < y.id);
    });
    told_below_ = distance;
  }
  const auto end = std::partition_point(
      told_.begin(), told_.end(), [&](const NearTriangle& one) { return one.least < distance; });
  return {told_.begin(), end};
}

}  // namespace keepout
