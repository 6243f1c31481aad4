// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "verify/robot/start.h"

namespace keepout::app {

/// An instrument beside a mesh, the distance that it keeps, and the judge's tree of the mesh.
struct RobotScene {
  Scene scene;
  double margin;  // [mm]
  const RobotUnderTest& robot = robots_under_test().front();
  std::shared_ptr<const oracle::TriangleTree> tree =
      std::make_shared<const oracle::TriangleTree>(scene.mesh());

  /// Draws a start apart from the mesh by more than so many margins; empty if it finds none.
  std::optional<RobotStart> start(Random& random, double margins = 1.0) {
    return find_start(scene, tree, robot, Begin::apart, margins * margin, random);
  }
};

}  // namespace keepout::app
