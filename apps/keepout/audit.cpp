// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "audit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "keepout/index/pd_tree.h"
#include "keepout/mesh/doctor.h"

namespace keepout::app {
namespace {

/// Whether the line through both points meets the triangle, by the signed volumes that it spans
/// with the three sides.
bool line_meets(const Triangle& triangle, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  std::array<double, 3> volume;
  for (int e = 0; e < 3; ++e) {
    volume[e] = along.cross(triangle[e] - from).dot(triangle[(e + 1) % 3] - from);
  }
  return (volume[0] >= 0.0 && volume[1] >= 0.0 && volume[2] >= 0.0) ||
         (volume[0] <= 0.0 && volume[1] <= 0.0 && volume[2] <= 0.0);
}

/// The angle of a triangle at the part of it where the closest point lies. [rad]
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
    : mesh_(std::move(mesh)),
      index_(std::make_unique<PdTree>(mesh_)),
      nearest_(*mesh_, *index_),
      candidates_(mesh_->triangle_count()) {
  const MeshFindings findings = examine(*mesh_);
  if (findings.is_watertight()) inside_.emplace(*mesh_);
  solid_is_outside_ = findings.is_inside_out();
}

double Audit::clearance(const Vec3& point, double guess) {
  const double distance = nearest_(point, guess).closest.distance;
  if (!inside_ || (*inside_)(point) == solid_is_outside_) return distance;
  return distance <= touching ? 0.0 : -distance;
}

Side Audit::side(const Vec3& point) {
  const Hit nearest = nearest_(point);
  if (nearest.closest.distance <= touching) return Side::touching;
  const bool behind =
      inside_ ? (*inside_)(point) != solid_is_outside_ : is_behind_sheet(point, nearest);
  return behind ? Side::behind : Side::front;
}

bool Audit::is_behind_sheet(const Vec3& point, const Hit& nearest) {
  // Triangles that share the closest point share its bits: they are the ones around it.
  candidates_.clear();
  index_->collect({point, nearest.closest.distance}, candidates_);
  Vec3 normal = Vec3::Zero();
  for (const TriangleId t : candidates_) {
    const Triangle triangle = mesh_->triangle(t);
    const ClosestPoint closest = closest_point(triangle, point);
    if (closest.offset != nearest.closest.offset) continue;
    normal += angle_at(triangle, closest.feature) * unit_normal(triangle);
  }
  return normal.dot(-nearest.closest.offset) < 0.0;
}

std::vector<double> Audit::meetings(const Vec3& from, const Vec3& to) {
  std::vector<double> shares;
  candidates_.clear();
  index_->collect({0.5 * (from + to), 0.5 * (to - from).norm() + touching}, candidates_);
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

}  // namespace keepout::app
