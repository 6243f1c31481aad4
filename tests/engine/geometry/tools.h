// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/geometry/convex_tool.h"

namespace keepout::test {

struct NamedTool {
  std::string name;
  ConvexTool tool;
};

inline Eigen::Matrix3d random_rotation(keepout::Random& random) {
  const Vec3 axis = random.direction();
  return Eigen::AngleAxisd(random.uniform(0.0, 6.0), axis).toRotationMatrix();
}

/// Returns a tool of each kind, about `size` large, around the tip.
inline std::vector<NamedTool> tools_of_each_kind(double size, keepout::Random& random) {
  std::vector<Vec3> points;
  for (int i = 0; i < 10; ++i) points.push_back(0.5 * size * random.direction());
  std::vector<NamedTool> tools;
  tools.push_back({"sphere", ConvexTool::sphere(0.4 * size)});
  tools.push_back(
      {"capsule", ConvexTool::capsule(Vec3::Zero(), size * random.direction(), 0.2 * size)});
  tools.push_back(
      {"box", ConvexTool::box({Vec3(-0.5, -0.3, -0.2) * size, Vec3(0.5, 0.3, 0.2) * size})
                  .rotated(random_rotation(random))});
  tools.push_back({"hull", ConvexTool::hull(points, 0.05 * size)});
  return tools;
}

}  // namespace keepout::test
