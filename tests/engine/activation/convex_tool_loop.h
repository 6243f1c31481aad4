// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/geometry/reference_separation.h"
#include "keepout/activation/convex_tool_rule.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/index/pd_tree.h"
#include "keepout/solvers/active_set.h"
#include "keepout/step/motion_constraint.h"

namespace keepout::test {

inline constexpr double margin = 0.2;
inline constexpr double radius = 2.0;
inline constexpr double tiny = 1e-8;  // far above the rule's tolerance, far below the margin

inline std::shared_ptr<const Mesh> shape(std::string_view name) {
  return std::make_shared<const Mesh>(make_shape(name));
}

inline MotionConstraint guard(const std::shared_ptr<const Mesh>& mesh, const ConvexTool& tool,
                              std::unique_ptr<NarrowPhase> narrow_phase = nullptr,
                              StepOptions options = {.radius = radius, .margin = margin}) {
  return {mesh, std::make_unique<PdTree>(mesh),
          std::make_unique<ConvexToolRule>(tool, std::move(narrow_phase)),
          std::make_unique<ActiveSet>(), options};
}

/// Returns the distance that a plane proves, in 64-bit arithmetic: at most the true one, for any
/// normal. [length]
inline double proven_by(const Vec3& normal, std::span<const Vec3> core, const Triangle& triangle) {
  using Real = long double;
  const auto along = [&](const Vec3& p) {
    return Real{normal.x()} * p.x() + Real{normal.y()} * p.y() + Real{normal.z()} * p.z();
  };
  Real low = std::numeric_limits<Real>::infinity();
  Real high = -low;
  for (const Vec3& p : core) low = std::min(low, along(p));
  for (const Vec3& v : triangle) high = std::max(high, along(v));
  return static_cast<double>((low - high) / std::sqrt(along(normal)));
}

/// Judges each motion of a tool against all triangles that it can reach. Only the index and the
/// proposed normals are the engine's.
class ToolJudge {
 public:
  ToolJudge(std::shared_ptr<const Mesh> mesh, const ConvexTool& tool)
      : mesh_(mesh), tool_(tool), index_(mesh), candidates_(mesh->triangle_count()) {}

  /// Returns the least clearance on the motion, or a lower bound that is at least `enough`.
  /// [length]
  double clearance(const Vec3& from, const Vec3& to, double enough) {
    const Ball& bounds = tool_.bounding_ball();
    candidates_.clear();
    index_.collect({0.5 * (from + to) + bounds.center,
                    0.5 * (to - from).norm() + bounds.radius + enough + 1e-6},
                   candidates_);
    std::vector<Vec3> core;  // of the swept tool
    for (const Vec3& p : tool_.points()) core.insert(core.end(), {from + p, to + p});
    const ConvexTool swept = ConvexTool::hull(core);
    double least = std::numeric_limits<double>::infinity();
    for (const TriangleId t : candidates_) {
      const Triangle triangle = mesh_->triangle(t);
      double apart = proven_by(separation(swept, Vec3::Zero(), triangle).normal, core, triangle);
      if (!(apart - tool_.radius() >= enough)) apart = reference_separation(core, triangle);
      least = std::min(least, apart - tool_.radius());
    }
    return least;
  }

 private:
  std::shared_ptr<const Mesh> mesh_;
  ConvexTool tool_;
  PdTree index_;
  TriangleBuffer candidates_;
};

}  // namespace keepout::test
