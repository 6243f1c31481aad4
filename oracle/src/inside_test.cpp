// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/inside_test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "integer_frame.h"

namespace keepout::oracle {
namespace {

// The determinant is a sum of six products of three differences. Each difference is off by u =
// 2^-53. The products have two more roundings, the inner difference one, and the sums two. That is
// 8 u relative to the sum of the products' magnitudes. 16 u also covers the terms in u^2 and the
// rounding of the magnitude. Underflow (about 2^-1074 times a factor below 1e30) is far below 16 u
// times the least magnitude.
constexpr double rounding = 0x1p-49;
constexpr double least_magnitude = 1e-250;
constexpr double largest_factor = 1e30;

int exact_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  IntegerFrame frame;
  for (const Vec3& v : {a, b, c, d}) frame.include(v);
  const IntegerVec apex = frame.integer(a);
  return sgn(dot(frame.integer(b) - apex, cross(frame.integer(c) - apex, frame.integer(d) - apex)));
}

/// Returns one representative for each vertex: the same for all vertices at the same position. (-0
/// equals 0.)
std::vector<VertexId> places(const Mesh& mesh) {
  std::vector<VertexId> order(mesh.vertex_count());
  std::iota(order.begin(), order.end(), VertexId{0});
  std::ranges::sort(order, {}, [&mesh](VertexId v) {
    const Vec3& p = mesh.vertex(v);
    return std::array<double, 3>{p[0], p[1], p[2]};
  });
  std::vector<VertexId> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool repeats = i > 0 && mesh.vertex(order[i]) == mesh.vertex(order[i - 1]);
    place[order[i]] = repeats ? place[order[i - 1]] : order[i];
  }
  return place;
}

bool every_edge_is_even(const Mesh& mesh) {
  const std::vector<VertexId> place = places(mesh);
  std::vector<std::pair<VertexId, VertexId>> edges;
  edges.reserve(3 * mesh.triangle_count());
  for (const Corners& corners : mesh.triangles()) {
    for (int i = 0; i < 3; ++i) {
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

enum class Piercing { no, yes, unclear };

/// Decides if a segment pierces a triangle. Returns `unclear` if the line meets the border of the
/// triangle, or the segment starts on the triangle. Precondition: `to` is not in the triangle's
/// plane, or the line misses the triangle.
Piercing piercing(const Segment& segment, const Triangle& t) {
  int left = 0, right = 0;
  for (int i = 0; i < 3; ++i) {
    const int sign = volume_sign(segment.from, segment.to, t[i], t[(i + 1) % 3]);
    left += sign > 0;
    right += sign < 0;
  }
  if (left > 0 && right > 0) return Piercing::no;
  if (left + right < 3) return Piercing::unclear;
  const int from_side = volume_sign(segment.from, t[0], t[1], t[2]);
  if (from_side == 0) return Piercing::unclear;
  return from_side == volume_sign(segment.to, t[0], t[1], t[2]) ? Piercing::no : Piercing::yes;
}

}  // namespace

int volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
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
  if (in_range && std::abs(sum) > rounding * magnitude) return sum > 0.0 ? 1 : -1;
  return exact_sign(a, b, c, d);
}

InsideTest::InsideTest(std::shared_ptr<const TriangleTree> tree)
    : tree_(std::move(tree)), closed_(every_edge_is_even(tree_->mesh())) {}

std::optional<bool> InsideTest::inside(const Vec3& point) const {
  if (!closed_) return std::nullopt;
  const Bounds bounds = tree_->bounds();
  if (!bounds.contains({point, point})) return false;

  std::mt19937_64 random(20261120);
  std::uniform_real_distribution<double> share(0.25, 1.0);
  // Beyond the farthest corner: outside the bounds, so not in the plane of a triangle that the ray
  // pierces.
  const double far =
      8.0 * (bounds.high - bounds.low).maxCoeff() + 0x1p-40 * bounds.low.lpNorm<1>() + 1e-200;
  std::vector<TriangleId> near;
  while (true) {
    Vec3 to = point;
    for (int i = 0; i < 3; ++i) to[i] += (random() % 2 == 0 ? far : -far) * share(random);
    near.clear();
    tree_->collect_along({point, to}, near);
    bool odd = false;
    bool clear = true;
    for (const TriangleId t : near) {
      const Triangle triangle = tree_->mesh().triangle(t);
      const Piercing found = piercing({point, to}, triangle);
      if (found == Piercing::yes) odd = !odd;
      if (found != Piercing::unclear) continue;
      if (exact_distance({point, point}, triangle, 0.0).against_zero == 0) return false;
      clear = false;
    }
    if (clear) return odd;
  }
}

}  // namespace keepout::oracle
