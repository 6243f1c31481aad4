// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/separation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "direction_of.h"
#include "keepout/geometry/nearest_points.h"

namespace keepout {
namespace {

/// The extent of points along a direction.
struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  Extent(std::span<const Vec3> points, const Vec3& n) noexcept {
    for (const Vec3& p : points) {
      const double far = n.dot(p);
      low = std::min(low, far);
      high = std::max(high, far);
    }
  }
};

/// The best of the directions tried so far.
class BestDirection {
 public:
  BestDirection(const ConvexTool& tool, const Triangle& triangle) noexcept
      : points_(tool.points()), triangle_(triangle) {}

  /// Tries n and -n. Any direction is sound: the separation along it never exceeds the distance.
  void consider(const Vec3& n) noexcept {
    const Extent core(points_, n);
    const Extent other(triangle_, n);
    take(n, core.low - other.high);
    take(-n, other.low - core.high);
  }

  void take(const Vec3& n, double apart) noexcept {
    if (!(apart > separation_)) return;
    normal_ = n;
    separation_ = apart;
  }

  bool found() const noexcept { return separation_ > -std::numeric_limits<double>::infinity(); }
  const Vec3& normal() const noexcept { return normal_; }
  double separation() const noexcept { return separation_; }

 private:
  std::span<const Vec3> points_;
  const Triangle& triangle_;
  Vec3 normal_ = Vec3::UnitX();
  double separation_ = -std::numeric_limits<double>::infinity();
};

/// Tries all directions along which the least motion may separate two overlapping cores: the face
/// normals of their difference.
void consider_all(const ConvexTool& tool, const Triangle& triangle, BestDirection& best) noexcept {
  const Vec3 n = unit_normal(triangle);
  if (!n.isZero(0.0)) best.consider(n);
  for (const Vec3& normal : tool.face_normals()) best.consider(normal);
  Vec3 some_edge = Vec3::Zero();
  for (const Vec3& edge : tool.edge_directions()) some_edge = edge;
  for (int e = 0; e < 3; ++e) {
    const Vec3 side = direction_of(triangle[(e + 1) % 3] - triangle[e]);
    if (side.isZero(0.0)) continue;
    some_edge = side;
    for (const Vec3& edge : tool.edge_directions()) {
      const Vec3 across = direction_of(edge.cross(side));
      if (!across.isZero(0.0)) best.consider(across);
    }
  }
  // On a line, any direction across it will do; at a point, any direction.
  if (!best.found())
    best.consider(some_edge.isZero(0.0) ? Vec3::UnitX() : some_edge.unitOrthogonal());
}

Triangle moved(const Triangle& triangle, const Vec3& by) noexcept {
  return {triangle[0] + by, triangle[1] + by, triangle[2] + by};
}

}  // namespace

double separation_along(const Vec3& n, const ConvexTool& tool, const Vec3& position,
                        const Triangle& triangle) noexcept {
  const Triangle local = moved(triangle, -position);
  return Extent(tool.points(), n).low - Extent(local, n).high - tool.radius();
}

Separation separation(const ConvexTool& tool, const Vec3& position,
                      const Triangle& triangle) noexcept {
  const Triangle local = moved(triangle, -position);
  double size = 0.0;
  for (const Vec3& corner : local) size = std::max(size, corner.norm());
  for (const Vec3& point : tool.points()) size = std::max(size, point.norm());

  const NearestPoints nearest = nearest_points(tool.points(), local);
  // A plane proves the distance up to some roundings. If the proof fails, all directions are tried.
  constexpr double roundings = 4e-15;
  if (!nearest.overlap && nearest.distance - nearest.proven <= roundings * size) {
    return {nearest.distance - tool.radius(), nearest.normal, position + nearest.on_triangle};
  }
  BestDirection best(tool, local);
  consider_all(tool, local, best);
  if (!nearest.overlap) best.take(nearest.normal, nearest.proven);
  // The distance of a point is exact even if its normal is not.
  const bool is_point = tool.points().size() == 1;
  if (is_point && !nearest.overlap && best.separation() > 0.0) {
    return {nearest.distance - tool.radius(), best.normal(), position + nearest.on_triangle};
  }
  // For other cores with lengths of different orders, the search may have ended too far away. The
  // result is then the distance that the best plane proves, or the depth.
  const double apart = nearest.overlap ? std::min(best.separation(), 0.0) : best.separation();

  // If both are moved apart along the normal by more than the depth, the deepest points become the
  // nearest ones.
  const Vec3 way = (size - best.separation()) * best.normal();
  const NearestPoints parted = nearest_points(tool.points(), moved(local, -way));
  return {apart - tool.radius(), best.normal(), position + (parted.on_triangle + way)};
}

bool is_in_range(const Vec3& position, const Triangle& triangle) noexcept {
  const auto within = [](const Vec3& v) { return (v.array().abs() <= 1e30).all(); };
  return within(position) && within(triangle[0]) && within(triangle[1]) && within(triangle[2]);
}

NarrowPhaseAnswer ExactNarrowPhase::separation(const Vec3& position,
                                               const Triangle& triangle) noexcept {
  return {keepout::separation(tool_, position, triangle), {}};
}

}  // namespace keepout
