// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/mesh/mesh.h"

namespace keepout::peers {

/// The end of a motion that another library allows.
struct SweepEnd {
  double fraction;  // of the motion for which the ball is free, 0 to 1; 1 if it never touches
  Vec3 normal;      // of the contact, towards the ball; zero without a contact
};

/// Another library's answer for a small ball that moves past a mesh. Each object copies the mesh.
/// Precondition: the radius is above 0; it is the required distance. [length]
class Sweep {
 public:
  virtual ~Sweep() = default;

  /// Returns the end of a motion of the ball's center.
  virtual SweepEnd operator()(const Vec3& tip, const Vec3& motion) const = 0;
};

/// FCL's continuous collision with CCDC_NAIVE, its default solver. It tests the ball at places
/// along the motion, with the start and the end, and reports the first place that collides. The end
/// is the place before; it is the start if the ball collides there. The normal is that of the
/// deepest contact at the place that collides. Places are at most half a radius apart, so the ball
/// cannot pass a surface without a collision. Boxes are OBBRSS and the solver for pairs is
/// libccd's, as usual.
std::unique_ptr<Sweep> continuous_collision(const Mesh& mesh, double radius);

/// FCL's continuous collision with CCDC_CONSERVATIVE_ADVANCEMENT, which needs no places. It misses
/// contacts of a ball with a mesh; tests/experiments/test_rules.py counts them. Users report the
/// same for meshes (FCL's issue 120).
std::unique_ptr<Sweep> conservative_advancement(const Mesh& mesh, double radius);

/// Bullet's sweep, as its character controllers use it: btCollisionWorld::convexSweepTest of a
/// btSphereShape, against one btBvhTriangleMeshShape. Settings:
///
/// - double precision, and the usual compressed tree of boxes;
/// - no margin of the mesh, because the ball is its own exact margin;
/// - allowedCcdPenetration of 0, the default.
///
/// Bullet assumes meters and ends a sweep within 0.001 of contact, which is 0.001 mm here. If a
/// ball starts that close, Bullet returns 0 if it approaches, and free if it moves away.
std::unique_ptr<Sweep> convex_sweep(const Mesh& mesh, double radius);

}  // namespace keepout::peers
