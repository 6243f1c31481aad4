// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/mesh/mesh.h"

namespace keepout::peers {

/// Bullet's sweep of a small ball past a mesh, as its character controllers use it:
/// btCollisionWorld::convexSweepTest of a btSphereShape, here against the one mesh alone, a
/// btBvhTriangleMeshShape. Settings:
///
/// - double precision, and the compressed tree of boxes, which is the usual one;
/// - no margin of the mesh: the ball is its own margin, exactly, so that a margin would add to it;
/// - allowedCcdPenetration of 0, the argument by default.
///
/// Bullet means metres, and ends a sweep within 0.001 of a touch, here 0.001 mm. A ball that is as
/// near when it starts is told 0 if it goes nearer, and to be free if it goes away.
class ConvexSweep {
 public:
  /// The mesh is copied. `radius` > 0: the ball's, which is the distance to be kept. [length]
  ConvexSweep(const Mesh& mesh, double radius);
  ~ConvexSweep();
  ConvexSweep(ConvexSweep&&) noexcept;

  /// The share of the motion, from 0 to 1, after which the ball touches; 1 if it never does.
  double time_of_impact(const Vec3& tip, const Vec3& motion) const;

 private:
  struct Bodies;
  std::unique_ptr<Bodies> bodies_;
};

}  // namespace keepout::peers
