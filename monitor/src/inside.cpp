// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/monitor/inside.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace keepout::monitor {
namespace {

// The determinant is a sum of six products of three differences. Each difference is off by u =
// 2^-53. The products have two more roundings, the inner difference one, and the sums two. That is
// 8 u relative to the sum of the products' magnitudes. 16 u also covers the terms in u^2 and the
// rounding of the magnitude. Underflow (about 2^-1074 times a factor below 1e30) is far below 16 u
// times the least magnitude.
constexpr double rounding = 0x1p-49;
constexpr double least_magnitude = 1e-250;
constexpr double largest_factor = 1e30;

/// Directions of rays; any will do that are not those of a surface's own edges.
constexpr std::array<std::array<double, 3>, 8> factors{{{0.731, -0.417, 0.893},
                                                        {-0.613, 0.829, 0.371},
                                                        {0.457, 0.683, -0.967},
                                                        {-0.941, -0.577, -0.283},
                                                        {0.339, -0.991, 0.547},
                                                        {0.877, 0.293, 0.619},
                                                        {-0.269, 0.461, -0.743},
                                                        {0.593, -0.811, -0.359}}};

/// Returns one representative for each vertex: the same for all vertices at the same position. (-0
/// equals 0.)
std::vector<VertexId> places(const Mesh& mesh) {
  std::vector<VertexId> order(mesh.vertex_count());
  std::iota(order.begin(), order.end(), VertexId{0});
  const auto position = [&mesh](VertexId v) {
    const Vec3& p = mesh.vertex(v);
    return std::array<double, 3>{p[0], p[1], p[2]};
  };
  std::sort(order.begin(), order.end(),
            [&](VertexId one, VertexId other) { return position(one) < position(other); });
  std::vector<VertexId> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool repeats = i > 0 && mesh.vertex(order[i]) == mesh.vertex(order[i - 1]);
    place[order[i]] = repeats ? place[order[i - 1]] : order[i];
  }
  return place;
}

/// Returns 1 if normals point out of the volume, -1 if they point into it, and 0 if rounding hides
/// it.
int orientation_of(const Mesh& mesh) noexcept {
  const Vec3 middle = mesh.vertex(0);
  double volume = 0.0;
  double magnitude = 0.0;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle c = mesh.triangle(t);
    const double part = (c[0] - middle).dot((c[1] - middle).cross(c[2] - middle));
    volume += part;
    magnitude += std::abs(part);
  }
  if (!(std::abs(volume) > 1e-9 * magnitude)) return 0;
  return volume > 0.0 ? 1 : -1;
}

}  // namespace

std::optional<int> volume_sign(const Vec3& a, const Vec3& b, const Vec3& c,
                               const Vec3& d) noexcept {
  const Vec3 p = b - a;
  const Vec3 q = c - a;
  const Vec3 r = d - a;
  double sum = 0.0;
  double magnitude = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const double left = q[j] * r[k];
    const double right = q[k] * r[j];
    sum += p[i] * (left - right);
    magnitude += std::abs(p[i]) * (std::abs(left) + std::abs(right));
  }
  const bool in_range =
      magnitude >= least_magnitude && p.lpNorm<Eigen::Infinity>() < largest_factor;
  if (!in_range || !(std::abs(sum) > rounding * magnitude)) return std::nullopt;
  return sum > 0.0 ? 1 : -1;
}

bool is_closed(const Mesh& mesh) {
  const std::vector<VertexId> place = places(mesh);
  std::vector<std::pair<VertexId, VertexId>> edges;
  edges.reserve(3 * mesh.triangle_count());
  for (const Corners& corners : mesh.triangles()) {
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexId a = place[corners[i]], b = place[corners[(i + 1) % 3]];
      if (a != b) edges.emplace_back(std::minmax(a, b));
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if ((end - i) % 2 != 0) return false;
    i = end;
  }
  return true;
}

Vec3 beyond(const TriangleTree& tree, const Vec3& point, const Vec3& direction) noexcept {
  const Bounds& bounds = tree.bounds();
  return point +
         (8.0 * (bounds.high - bounds.low).maxCoeff() + 0x1p-40 * bounds.low.lpNorm<1>() + 1e-200) *
             direction;
}

SideTest::SideTest(std::shared_ptr<const TriangleTree> tree, std::uint64_t most_triangles)
    : tree_(std::move(tree)),
      most_triangles_(std::min<std::uint64_t>(most_triangles, tree_->mesh().triangle_count())),
      inside_(is_closed(tree_->mesh()) ? orientation_of(tree_->mesh()) : 0) {
  found_.reserve(static_cast<std::size_t>(most_triangles_));
}

std::optional<bool> SideTest::is_forbidden(const Vec3& point, std::uint64_t work) noexcept {
  if (inside_ == 0) return std::nullopt;
  if (!tree_->bounds().contains({point, point})) return inside_ < 0;
  const auto sign = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return volume_sign(a, b, c, d).value_or(0);
  };
  for (const std::array<double, 3>& factor : factors) {
    const Segment ray{point, beyond(*tree_, point, {factor[0], factor[1], factor[2]})};
    found_.clear();
    if (!tree_->collect_along(ray, found_, {most_triangles_, &work})) return std::nullopt;
    if (found_.size() > work) return std::nullopt;
    work -= found_.size();
    bool is_odd = false;
    bool is_clear = true;
    for (const TriangleId t : found_) {
      const Piercing found = piercing(ray, tree_->mesh().triangle(t), sign);
      is_odd ^= found == Piercing::yes;
      is_clear &= found != Piercing::unclear;
    }
    if (is_clear) return is_odd == (inside_ > 0);
  }
  return std::nullopt;
}

}  // namespace keepout::monitor
