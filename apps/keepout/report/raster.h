// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "keepout/mesh/mesh.h"
#include "report/camera.h"
#include "report/image.h"

namespace keepout::app {

/// What a sample of a picture shows.
enum class Shown : std::uint8_t {
  nothing,
  outside,  // of the surface: the free side
  inside,   // of the surface: the back of a triangle
  section   // the flat face that a cut leaves in a solid
};

/// The nearest surface on a grid of rays, finer than the pixels of the picture, rows from the top.
struct Samples {
  static constexpr int per_pixel = 2;  // in each direction

  ImageSize size;  // [sample]
  std::vector<Shown> shown;
  std::vector<float> depth;             // towards the viewer; -infinity: nothing there [sample]
  std::vector<Eigen::Vector3f> normal;  // unit: right, up, towards the viewer

  std::size_t at(int x, int y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
           static_cast<std::size_t>(x);
  }
};

/// What fills the place where a cut opens the surface.
enum class Interior : std::uint8_t {
  hollow,  // the back of the surface shows: for open surfaces
  solid    // a flat section shows: for closed surfaces with the free side outside
};

/// Finds what the camera sees of the mesh. `size` is that of the picture. [pixel]
Samples rasterize(const Mesh& mesh, const Camera& camera, ImageSize size, Interior interior);

/// Whether nothing of the mesh lies between a point and the viewer, or less than `slack`. [mm]
/// A point outside of the picture is not seen.
bool sees(const Samples& samples, const Camera& camera, const Vec3& point, double slack);

}  // namespace keepout::app
