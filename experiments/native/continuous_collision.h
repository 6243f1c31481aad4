// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/mesh/mesh.h"

namespace keepout::peers {

/// FCL's continuous collision of a small ball with a mesh, by CCDC_NAIVE: it places the ball all
/// along the motion, at the start and the end as well, and tells the first place where it collides.
///
/// This is FCL's solver by default. CCDC_CONSERVATIVE_ADVANCEMENT, which needs no samples, finds no
/// contact of a ball with a mesh (FCL 0.7: none of 30 with boxes RSS, OBBRSS and AABB, either
/// solver for the pairs, and either body moving); users report the like of meshes (FCL's issue
/// 120). The places are half a radius apart at the most, so that none can be on the other side of a
/// surface without one before that collides. Boxes are OBBRSS, the solver for pairs is libccd's, as
/// is usual.
class ContinuousCollision {
 public:
  /// The mesh is copied. `radius` > 0: the ball's, which is the distance to be kept. [length]
  ContinuousCollision(const Mesh& mesh, double radius);
  ~ContinuousCollision();
  ContinuousCollision(ContinuousCollision&&) noexcept;

  /// The share of the motion, from 0 to 1, at the last place before the ball collides; 1 if it
  /// never does, and 0 if it does at the start.
  double time_of_impact(const Vec3& tip, const Vec3& motion) const;

 private:
  struct Bodies;
  std::unique_ptr<const Bodies> bodies_;
};

}  // namespace keepout::peers
