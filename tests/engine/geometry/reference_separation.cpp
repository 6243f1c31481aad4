// SPDX-License-Identifier: BSD-3-Clause
#include "engine/geometry/reference_separation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace keepout::test {
namespace {

using Real = long double;

struct Point {
  Real x, y, z;
};

Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Point operator*(Real s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
Real dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Real norm(const Point& a) { return std::sqrt(dot(a, a)); }
Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Point point(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Real origin_to_segment(const Point& a, const Point& b) {
  const Point ab = b - a;
  const Real length2 = dot(ab, ab);
  if (length2 == 0) return norm(a);
  return norm(a + std::clamp<Real>(-dot(a, ab) / length2, 0, 1) * ab);
}

/// Returns the distance to the inside of the triangle; infinite if the origin projects elsewhere.
Real origin_to_face(const Point& a, const Point& b, const Point& c, const Point& normal) {
  const Real n2 = dot(normal, normal);
  const Real of_b = dot(cross(c - a, a), normal) / n2;
  const Real of_c = dot(cross(a, b - a), normal) / n2;
  if (of_b < 0 || of_c < 0 || of_b + of_c > 1) return std::numeric_limits<Real>::infinity();
  return std::abs(dot(a, normal)) / std::sqrt(n2);
}

}  // namespace

double reference_separation(std::span<const Vec3> points, const Triangle& triangle) {
  std::vector<Point> corners;
  for (const Vec3& p : points) {
    for (const Vec3& t : triangle) corners.push_back(point(p) - point(t));
  }
  const std::size_t count = corners.size();
  Real nearest = std::numeric_limits<Real>::infinity();
  Real parted = -std::numeric_limits<Real>::infinity();  // by the best separating plane
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      nearest = std::min(nearest, origin_to_segment(corners[i], corners[j]));
      for (std::size_t k = 0; k < j; ++k) {
        const Point a = corners[j] - corners[i];
        const Point b = corners[k] - corners[i];
        const Point n = cross(a, b);
        const Real size = norm(n);
        // Three collinear corners (up to rounding) are no face.
        if (!(size > 1e-17L * (dot(a, a) + dot(b, b)))) continue;
        nearest = std::min(nearest, origin_to_face(corners[i], corners[j], corners[k], n));
        Real low = std::numeric_limits<Real>::infinity();
        Real high = -low;
        for (const Point& corner : corners) {
          low = std::min(low, dot(n, corner));
          high = std::max(high, dot(n, corner));
        }
        parted = std::max({parted, low / size, -high / size});
      }
    }
  }
  // If the difference has no volume, some plane always separates by zero or more.
  return static_cast<double>(parted < 0 && std::isfinite(parted) ? parted : nearest);
}

}  // namespace keepout::test
