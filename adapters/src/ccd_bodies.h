// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ccd/ccd.h>

#include "keepout/geometry/convex_tool.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// The number of support queries that a pair of bodies still answers. EPA has no limit of its own,
/// in libccd or in FCL. It ends when a support point is no better than the last, which near a touch
/// may never happen. After the budget is spent, both bodies answer with the origin, which is no
/// better.
struct CcdBudget {
  int left;

  bool take() noexcept { return --left >= 0; }
  bool spent() const noexcept { return left < 0; }
};

/// A tool's core grown by a radius, in the tool's frame.
struct CcdTool {
  const ConvexTool* tool;
  double radius;  // [length]
  CcdBudget* budget;
};

/// A triangle relative to the tool.
struct CcdTriangle {
  const Triangle* triangle;
  CcdBudget* budget;
};

/// Returns the triangle in the frame of a tool at that position.
inline Triangle relative(const Triangle& triangle, const Vec3& position) {
  return {triangle[0] - position, triangle[1] - position, triangle[2] - position};
}

inline Vec3 from_ccd(const ccd_vec3_t& v) noexcept { return Vec3(v.v[0], v.v[1], v.v[2]); }

inline void to_ccd(const Vec3& v, ccd_vec3_t* out) noexcept {
  ccdVec3Set(out, v.x(), v.y(), v.z());
}

// Callbacks for C.

inline void ccd_tool_support(const void* body, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& tool = *static_cast<const CcdTool*>(body);
  if (!tool.budget->take()) return to_ccd(Vec3::Zero(), out);
  const Vec3 n = from_ccd(*direction);
  const double length = n.norm();
  Vec3 farthest = tool.tool->support(n);
  if (length > 0.0) farthest += (tool.radius / length) * n;
  to_ccd(farthest, out);
}

inline void ccd_triangle_support(const void* body, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& triangle = *static_cast<const CcdTriangle*>(body);
  if (!triangle.budget->take()) return to_ccd(Vec3::Zero(), out);
  const Vec3 n = from_ccd(*direction);
  const Triangle& corners = *triangle.triangle;
  int best = 0;
  for (int i = 1; i < 3; ++i) {
    if (n.dot(corners[i]) > n.dot(corners[best])) best = i;
  }
  to_ccd(corners[best], out);
}

inline void ccd_tool_center(const void* body, ccd_vec3_t* out) {
  to_ccd(static_cast<const CcdTool*>(body)->tool->bounding_ball().center, out);
}

inline void ccd_triangle_center(const void* body, ccd_vec3_t* out) {
  const Triangle& corners = *static_cast<const CcdTriangle*>(body)->triangle;
  to_ccd((corners[0] + corners[1] + corners[2]) / 3.0, out);
}

}  // namespace keepout
