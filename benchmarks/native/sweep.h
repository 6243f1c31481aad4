// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/mesh/mesh.h"

namespace keepout::peers {

/// What another library says of a small ball that moves past a mesh. Each copies the mesh.
/// Precondition: `radius` > 0, the ball's, which is the distance to be kept. [length]
class Sweep {
 public:
  virtual ~Sweep() = default;

  /// The share of the motion, from 0 to 1, that the ball is free for; 1 if it never touches.
  virtual double time_of_impact(const Vec3& tip, const Vec3& motion) const = 0;
};

/// FCL's continuous collision, by CCDC_NAIVE: it places the ball all along the motion, at the start
/// and the end as well, and tells the first place where it collides. The share is that of the last
/// place before; it is 0 if the ball collides at the start.
///
/// This is FCL's solver by default. CCDC_CONSERVATIVE_ADVANCEMENT, which needs no samples, finds no
/// contact of a ball with a mesh (FCL 0.7: none of 30 with boxes RSS, OBBRSS and AABB, either
/// solver for the pairs, and either body moving); users report the like of meshes (FCL's issue
/// 120). The places are half a radius apart at the most, so that none can be on the other side of a
/// surface without one before that collides. Boxes are OBBRSS, the solver for pairs is libccd's, as
/// is usual.
std::unique_ptr<Sweep> continuous_collision(const Mesh& mesh, double radius);

/// Bullet's sweep, as its character controllers use it: btCollisionWorld::convexSweepTest of a
/// btSphereShape, here against the one mesh alone, a btBvhTriangleMeshShape. Settings:
///
/// - double precision, and the compressed tree of boxes, which is the usual one;
/// - no margin of the mesh: the ball is its own margin, exactly, so that a margin would add to it;
/// - allowedCcdPenetration of 0, the argument by default.
///
/// Bullet means meters, and ends a sweep within 0.001 of a touch, here 0.001 mm. A ball that is as
/// near when it starts is told 0 if it goes nearer, and to be free if it goes away.
std::unique_ptr<Sweep> convex_sweep(const Mesh& mesh, double radius);

}  // namespace keepout::peers
