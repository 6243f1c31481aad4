// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "inside_test.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

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

}  // namespace keepout::app
