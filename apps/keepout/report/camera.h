// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "keepout/geometry/shapes.h"
#include "report/image.h"

namespace keepout::app {

/// A cut that follows a path, as a curtain hung along it does: all between it and the viewer is
/// taken away. So what lies on the path is seen where it is, above the surface or in the section
/// below it.
struct Cut {
  std::vector<Vec3> path;  // at least one point; beyond its ends the curtain goes on straight [mm]
  std::size_t start =
      0;  // of the path: the nearer to it, the more a point counts where paths cross
  Vec3 hang = Vec3::UnitY();  // unit; how the curtain hangs, at right angles to the camera's right
};

/// Looks at the scene along parallel rays, so that lengths can be compared all over the picture.
struct Camera {
  Vec3 target = Vec3::Zero();  // what the middle of the picture shows [mm]
  Vec3 right = Vec3::UnitX();  // unit, as are the next two; together a right-handed frame
  Vec3 up = Vec3::UnitY();
  Vec3 toward = Vec3::UnitZ();  // to the viewer
  double view_height = 1.0;     // from the bottom to the top of the picture, > 0 [mm]
  std::optional<Cut> cut;
};

/// A camera that looks at the target against `toward`, with `up` upwards as far as that goes.
/// Precondition: neither is zero. Where they are parallel, any upright is as good.
Camera look_from(const Vec3& toward, const Vec3& up, const Vec3& target, double view_height);

/// Moves the camera sideways and widens its view until all points are in the picture, with a
/// margin.
void fit(Camera& camera, ImageSize size, std::span<const Vec3> points);

/// Where the picture shows a point.
struct PicturePoint {
  double x = 0.0;      // to the right [pixel]
  double y = 0.0;      // downwards [pixel]
  double depth = 0.0;  // towards the viewer, 0 at the target [pixel]
};
PicturePoint project(const Camera& camera, ImageSize size, const Vec3& point);

/// Whether a point is within the frame of the picture.
bool shows(const Camera& camera, ImageSize size, const Vec3& point);

}  // namespace keepout::app
