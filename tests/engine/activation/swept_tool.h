// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/geometry/reference_separation.h"
#include "keepout/geometry/convex_tool.h"

namespace keepout::test {

/// The core of a tool all along a straight motion: the hull of where it begins and where it ends.
inline std::vector<Vec3> swept_core(const ConvexTool& tool, const Vec3& from, const Vec3& to) {
  std::vector<Vec3> points;
  for (const Vec3& p : tool.points()) {
    points.push_back(from + p);
    points.push_back(to + p);
  }
  return points;
}

/// How far a plane keeps a core from a triangle, in arithmetic of 64 bits. Whatever the normal,
/// they are no nearer than that.
inline double proven_by(const Vec3& normal, std::span<const Vec3> core, const Triangle& triangle) {
  using Real = long double;
  const auto along = [&](const Vec3& p) {
    return Real{normal.x()} * p.x() + Real{normal.y()} * p.y() + Real{normal.z()} * p.z();
  };
  const Real length = std::sqrt(along(normal));
  Real low = std::numeric_limits<Real>::infinity();
  Real high = -low;
  for (const Vec3& p : core) low = std::min(low, along(p));
  for (const Vec3& v : triangle) high = std::max(high, along(v));
  return static_cast<double>((low - high) / length);
}

/// The clearance of a swept tool, or a part of it that is enough: proven by one of the normals, if
/// one will do, and by brute force if not. Nothing here is the engine's but the proposals.
inline double swept_clearance(const ConvexTool& tool, std::span<const Vec3> core,
                              const Triangle& triangle, std::span<const Vec3> normals,
                              double enough) {
  for (const Vec3& n : normals) {
    const double clearance = proven_by(n, core, triangle) - tool.radius();
    if (clearance >= enough) return clearance;
  }
  return reference_separation(core, triangle) - tool.radius();
}

}  // namespace keepout::test
