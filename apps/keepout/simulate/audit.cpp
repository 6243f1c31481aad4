// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/audit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "keepout/mesh/diagnostics.h"

namespace keepout::app {
namespace {

/// Returns true if the line through both points meets the triangle: the signed volumes that it
/// spans with the three sides then have equal signs.
bool line_meets(const Triangle& triangle, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  std::array<double, 3> volume;
  for (int e = 0; e < 3; ++e) {
    volume[e] = along.cross(triangle[e] - from).dot(triangle[(e + 1) % 3] - from);
  }
  return (volume[0] >= 0.0 && volume[1] >= 0.0 && volume[2] >= 0.0) ||
         (volume[0] <= 0.0 && volume[1] <= 0.0 && volume[2] <= 0.0);
}

/// Returns the angle of a triangle at the feature that contains the closest point. [rad]
double angle_at(const Triangle& triangle, Feature feature) {
  constexpr double pi = 3.141592653589793;
  if (is_face(feature)) return 2.0 * pi;
  if (is_edge(feature)) return pi;
  const int corner = number_of(feature);
  const Vec3 a = triangle[(corner + 1) % 3] - triangle[corner];
  const Vec3 b = triangle[(corner + 2) % 3] - triangle[corner];
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

Audit::Audit(std::shared_ptr<const Mesh> mesh)
    : mesh_(std::move(mesh)), tree_(std::make_shared<const monitor::TriangleTree>(mesh_)) {
  const MeshFindings findings = examine(*mesh_);
  if (findings.is_watertight()) inside_.emplace(tree_);
  solid_is_outside_ = findings.is_inside_out();
}

Side Audit::side(const Vec3& point, double distance) {
  if (distance <= touching) return Side::touching;
  const bool behind =
      inside_ ? inside_->inside(point) != solid_is_outside_ : is_behind_sheet(point);
  return behind ? Side::behind : Side::front;
}

double Audit::clearance(const Vec3& point) {
  const double away = distance(point);
  return clearance(away, inside_ ? side(point, away) : Side::front);
}

double Audit::clearance(double distance, Side side) const noexcept {
  if (!inside_ || side == Side::front) return distance;
  return side == Side::behind ? -distance : 0.0;
}

Hit Audit::nearest(const Vec3& point) {
  // The bound allows for the different rounding of kernel and oracle.
  const double reach = distance(point) * (1.0 + 1e-6) + 1e-12 * point.lpNorm<1>();
  candidates_.clear();
  tree_->collect(oracle::inflated({point, point}, reach), candidates_);
  Hit best{no_triangle, {}};
  for (const TriangleId t : candidates_) {
    const ClosestPoint closest = closest_point(mesh_->triangle(t), point);
    const bool nearer = best.triangle == no_triangle || closest.distance < best.closest.distance ||
                        (closest.distance == best.closest.distance && t < best.triangle);
    if (nearer) best = {t, closest};
  }
  return best;
}

bool Audit::is_behind_sheet(const Vec3& point) {
  const Hit hit = nearest(point);
  // Triangles around a shared closest point compute it bitwise identically.
  Vec3 normal = Vec3::Zero();
  for (const TriangleId t : candidates_) {
    const Triangle triangle = mesh_->triangle(t);
    const ClosestPoint closest = closest_point(triangle, point);
    if (closest.offset != hit.closest.offset) continue;
    normal += angle_at(triangle, closest.feature) * unit_normal(triangle);
  }
  return normal.dot(-hit.closest.offset) < 0.0;
}

std::vector<double> Audit::meetings(const Vec3& from, const Vec3& to) {
  std::vector<double> shares;
  candidates_.clear();
  tree_->collect(oracle::inflated(monitor::bounds_of(monitor::Segment{from, to}), touching),
                 candidates_);
  for (const TriangleId t : candidates_) {
    const Triangle triangle = mesh_->triangle(t);
    const Vec3 normal = unit_normal(triangle);
    const double before = normal.dot(from - triangle[0]);
    const double after = normal.dot(to - triangle[0]);
    if ((before > 0.0) == (after > 0.0) || !line_meets(triangle, from, to)) continue;
    shares.push_back(std::clamp(before / (before - after), 0.0, 1.0));
  }
  std::sort(shares.begin(), shares.end());
  return shares;
}

PathAudit::PathAudit(Audit& audit, const Vec3& start)
    : audit_(&audit),
      at_(start),
      distance_(audit.distance(start)),
      here_(audit.side(start, distance_)),
      side_(here_) {}

bool PathAudit::follow(const Vec3& to) {
  const Vec3 from = std::exchange(at_, to);
  const double room = std::exchange(distance_, audit_->distance(to));
  // The motion is too short to reach a closed surface, so the side stays the same.
  const bool stays_clear = (to - from).norm() < 0.999 * (room - Audit::touching);
  if (stays_clear && audit_->surface() == SurfaceKind::closed) return false;
  const Side start = std::exchange(here_, audit_->side(to, distance_));
  // Each part of the motion between two contacts is on one side, which is the side of its middle.
  std::vector<double> meetings = audit_->meetings(from, to);
  if (start == Side::touching) meetings.insert(meetings.begin(), 0.0);
  if (here_ == Side::touching) meetings.push_back(1.0);
  met_ = met_ || !meetings.empty();

  bool crossed = false;
  for (std::size_t i = 1; i < meetings.size(); ++i) {
    const double middle = 0.5 * (meetings[i - 1] + meetings[i]);
    crossed |= changes_side(audit_->side(from + middle * (to - from)));
  }
  crossed |= changes_side(here_);
  if (here_ != Side::touching) met_ = false;
  return crossed;
}

bool PathAudit::changes_side(Side now) {
  if (now == Side::touching) return false;
  const Side before = std::exchange(side_, now);
  if (before == now || before == Side::touching) return false;
  // A path from one side of a closed surface to the other crosses it; a path may go around an open
  // one.
  return audit_->surface() == SurfaceKind::closed || met_;
}

}  // namespace keepout::app
