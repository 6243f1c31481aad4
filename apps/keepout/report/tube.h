// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "report/camera.h"
#include "report/image.h"
#include "report/raster.h"

namespace keepout::app {

using Rgb = std::array<std::uint8_t, 3>;  // sRGB

/// A thick line in space, such as the way of a tool tip. A single point makes a ball.
struct Tube {
  enum class Sight : std::uint8_t {
    hidden_by_surface,  // as a real thing would be
    through_surface     // drawn over everything: what is inside must be seen
  };
  std::vector<Vec3> points;  // [mm]
  double radius = 2.0;       // [pixel]
  Rgb color = {0, 0, 0};
  Sight sight = Sight::hidden_by_surface;
};

/// The tubes alone, transparent elsewhere: to be laid over the picture of the surface that the
/// samples were taken of. Tubes that are seen through the surface cover the others.
Image draw_tubes(const Samples& samples, const Camera& camera, std::span<const Tube> tubes);

}  // namespace keepout::app
