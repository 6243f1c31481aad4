// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <utility>

#include "engine/activation/swept_tool.h"
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

/// Holds each motion of a tool to all triangles that it could reach.
class ToolJudge {
 public:
  ToolJudge(std::shared_ptr<const Mesh> mesh, const ConvexTool& tool)
      : mesh_(mesh), tool_(tool), index_(mesh), candidates_(mesh->triangle_count()) {}

  /// The least clearance on the way, or what is enough. [length]
  double clearance(const Vec3& from, const Vec3& to, double enough) {
    const Ball& bounds = tool_.bounding_ball();
    candidates_.clear();
    index_.collect({0.5 * (from + to) + bounds.center,
                    0.5 * (to - from).norm() + bounds.radius + enough + 1e-6},
                   candidates_);
    const std::vector<Vec3> core = swept_core(tool_, from, to);
    double least = std::numeric_limits<double>::infinity();
    const ConvexTool swept = ConvexTool::hull(core);
    for (const TriangleId t : candidates_) {
      const Triangle triangle = mesh_->triangle(t);
      const std::array proposals{separation(swept, Vec3::Zero(), triangle).normal};
      least = std::min(least, swept_clearance(tool_, core, triangle, proposals, enough));
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
