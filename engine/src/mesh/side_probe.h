// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/geometry/closest_point.h"
#include "keepout/mesh/mesh.h"
#include "keepout/mesh/side_of_surface.h"

namespace keepout {

/// Classifies a point by a probe: a segment to a place close to the nearest point, inside the
/// triangle there that faces the point the most. The side of the first triangle that the probe
/// meets is the point's. The result depends neither on a sum of normals nor on rounding that
/// decides which of several triangles is the nearest. Use: aim() with the triangles of
/// nearest_ball(), then, unless is_on_surface(), side() with those of probe_ball().
class SideProbe {
 public:
  /// `nearest`: from the point to the mesh.
  SideProbe(const Mesh& mesh, const Vec3& point, const ClosestPoint& nearest) noexcept;

  /// Ball that holds every triangle which is as near as the nearest one, to within rounding.
  Ball nearest_ball() const noexcept { return {point_, as_near_}; }

  /// Aims the probe. Takes the triangles that touch nearest_ball(), and reorders them.
  void aim(std::span<TriangleId> candidates) noexcept;

  /// True if the point is on the surface, to within rounding: then side() needs no candidates.
  bool is_on_surface() const noexcept { return distance_ <= 1e3 * rounding_; }

  /// Ball around the probe. Precondition: aim.
  Ball probe_ball() const noexcept { return {point_, probe_.norm() * (1.0 + 1e-9)}; }

  /// Classifies the point. Takes the triangles that touch probe_ball(), in any order.
  SideOfSurface side(std::span<const TriangleId> candidates) const noexcept;

 private:
  const Mesh& mesh_;
  Vec3 point_;
  double rounding_;  // [length]
  double distance_;
  double as_near_;  // distance within which a triangle counts as nearest [length]
  Vec3 offset_;     // from the point to the nearest one
  Vec3 normal_ =
      Vec3::Zero();  // unit: of all triangles there, by their angles; zero if they cancel
  Triangle faced_ = {Vec3::Zero(), Vec3::Zero(),
                     Vec3::Zero()};  // the one that faces the point most
  Vec3 probe_ = Vec3::Zero();        // from the point [length]
};

}  // namespace keepout
