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

/// Whether the ray's (y, z) is on the higher-y side of edge pq at its z, where the edge spans it.
bool toggles(const Vec3& one, const Vec3& other, const Vec3& point) {
  const bool ordered = one.z() < other.z() || (one.z() == other.z() && one.y() < other.y());
  const Vec3& p = ordered ? one : other;
  const Vec3& q = ordered ? other : one;
  if ((p.z() <= point.z()) == (q.z() <= point.z())) return false;
  return (q.y() - p.y()) * (point.z() - p.z()) > (point.y() - p.y()) * (q.z() - p.z());
}

bool ray_hits(const Triangle& t, const Vec3& point) {
  bool over = false;
  for (int e = 0; e < 3; ++e) over ^= toggles(t[e], t[(e + 1) % 3], point);
  if (!over) return false;
  // Of a triangle that the line meets, is the meeting point ahead along +x? By the plane: the
  // point lies behind it, seen along the ray.
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  return normal.dot(t[0] - point) * normal.x() > 0.0;
}

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

InsideTest::InsideTest(const Mesh& mesh) : mesh_(&mesh), bounds_(mesh.bounds()) {
  // About one triangle a cell and layer: anatomy has some ten layers.
  const double cells =
      std::clamp(std::sqrt(static_cast<double>(mesh.triangle_count()) / 8.0), 1.0, 4096.0);
  for (int axis : {0, 1}) {
    cells_[axis] = static_cast<std::size_t>(cells);
    cell_size_[axis] = bounds_.size()[axis + 1] / static_cast<double>(cells_[axis]);
  }
  const auto for_each_cell = [&](TriangleId t, auto&& visit) {
    const Triangle corners = mesh.triangle(t);
    const Vec3 low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
    const Vec3 high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
    for (std::size_t z = column(1, low.z()); z <= column(1, high.z()); ++z) {
      for (std::size_t y = column(0, low.y()); y <= column(0, high.y()); ++y) {
        visit(z * cells_[0] + y);
      }
    }
  };
  begin_.assign(cells_[0] * cells_[1] + 1, 0);
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    for_each_cell(t, [&](std::size_t cell) { ++begin_[cell + 1]; });
  }
  for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  triangles_.resize(begin_.back());
  std::vector<std::size_t> fill(begin_.begin(), begin_.end() - 1);
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    for_each_cell(t, [&](std::size_t cell) { triangles_[fill[cell]++] = t; });
  }
}

std::size_t InsideTest::column(int axis, double coordinate) const {
  if (!(cell_size_[axis] > 0.0)) return 0;
  const double cell = std::floor((coordinate - bounds_.low[axis + 1]) / cell_size_[axis]);
  return static_cast<std::size_t>(std::clamp(cell, 0.0, static_cast<double>(cells_[axis] - 1)));
}

bool InsideTest::operator()(const Vec3& point) const {
  const bool outside_box =
      (point.array() < bounds_.low.array()).any() || (point.array() > bounds_.high.array()).any();
  if (outside_box) return false;
  const std::size_t cell = column(1, point.z()) * cells_[0] + column(0, point.y());
  bool inside = false;
  for (std::size_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
    inside ^= ray_hits(mesh_->triangle(triangles_[i]), point);
  }
  return inside;
}

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

PathAudit::PathAudit(Audit& audit, const Vec3& start)
    : audit_(&audit), at_(start), here_(audit.side(start)), side_(here_) {}

bool PathAudit::follow(const Vec3& to) {
  const Vec3 from = std::exchange(at_, to);
  const Side start = std::exchange(here_, audit_->side(to));
  // Parts of the way between two meetings lie on one side each: their middles tell which.
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
  // Whoever leaves a closed surface went through it; an open one can be walked around.
  return audit_->surface() == SurfaceKind::closed || met_;
}

}  // namespace keepout::app
