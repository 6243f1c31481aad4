// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/mesh/mesh.h"

namespace keepout::peers {

/// Another library's answer for a small ball that moves past a mesh. Each object copies the mesh.
/// Precondition: `radius` > 0; it is the required distance. [length]
class Sweep {
 public:
  virtual ~Sweep() = default;

  /// Returns the fraction of the motion, from 0 to 1, for which the ball is free; 1 if it never
  /// touches.
  virtual double time_of_impact(const Vec3& tip, const Vec3& motion) const = 0;
};

/// FCL's continuous collision with CCDC_NAIVE. It tests the ball at places along the motion, with
/// the start and the end, and reports the first place that collides. The fraction is that of the
/// place before; it is 0 if the ball collides at the start.
///
/// This is FCL's default solver. CCDC_CONSERVATIVE_ADVANCEMENT, which needs no samples, finds no
/// contact of a ball with a mesh. In FCL 0.7 it found none of 30, with boxes RSS, OBBRSS and AABB,
/// with either solver for the pairs, and with either body moving. Users report the same for meshes
/// (FCL's issue 120). The places are at most half a radius apart, so the ball cannot pass a surface
/// without a collision. Boxes are OBBRSS and the solver for pairs is libccd's, as usual.
std::unique_ptr<Sweep> continuous_collision(const Mesh& mesh, double radius);

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
