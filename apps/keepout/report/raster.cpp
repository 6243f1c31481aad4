// SPDX-License-Identifier: BSD-3-Clause
#include "report/raster.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "report/curtain.h"

namespace keepout::app {
namespace {

using Vec3f = Eigen::Vector3f;

constexpr float nowhere = -std::numeric_limits<float>::infinity();

/// Corners sharper than this (cosine of the angle between a triangle and the mean of those around
/// its corner) stay sharp; all others are shaded as if the surface were smooth.
constexpr float crease_cosine = 0.6F;

/// How far a triangle reaches past its edges, as a part of its height: rounding would otherwise
/// leave pinholes between neighbours.
constexpr float seam = 1e-4F;

/// The vertices as the camera sees them: right, up, towards the viewer, from the middle of the
/// picture. Single precision is ample here: the large offset of the scene is taken off before.
std::vector<Vec3f> to_view(const Mesh& mesh, const Camera& camera, double scale) {
  Eigen::Matrix3d rotation;
  rotation << camera.right.transpose(), camera.up.transpose(), camera.toward.transpose();
  rotation *= scale;
  std::vector<Vec3f> result;
  result.reserve(mesh.vertex_count());
  for (const Vec3& vertex : mesh.vertices()) {
    result.emplace_back((rotation * (vertex - camera.target)).cast<float>());
  }
  return result;
}

/// Mean normal of the triangles around each vertex, weighted by area.
std::vector<Vec3f> smooth_normals(const Mesh& mesh, const std::vector<Vec3f>& view) {
  std::vector<Vec3f> result(view.size(), Vec3f::Zero());
  for (const Corners& c : mesh.triangles()) {
    const Vec3f area = (view[c[1]] - view[c[0]]).cross(view[c[2]] - view[c[0]]);
    for (const VertexId v : c) result[v] += area;
  }
  for (Vec3f& normal : result) normal.normalize();
  return result;
}

class Raster {
 public:
  Raster(Samples& samples, const Curtain& curtain) : samples_(samples), curtain_(curtain) {}

  /// `make_normals()` gives the normals at the corners. It is asked for only when the triangle is
  /// seen: of a fine mesh, few are.
  template <class MakeNormals>
  void draw(const Vec3f& a, const Vec3f& b, const Vec3f& c, const MakeNormals& make_normals) {
    const float x0 = column(a), x1 = column(b), x2 = column(c);
    const float y0 = row(a), y1 = row(b), y2 = row(c);
    const int left = first(std::min({x0, x1, x2}), samples_.size.width);
    const int right = last(std::max({x0, x1, x2}), samples_.size.width);
    const int top = first(std::min({y0, y1, y2}), samples_.size.height);
    const int bottom = last(std::max({y0, y1, y2}), samples_.size.height);
    if (left > right || top > bottom) return;
    const float area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
    if (area == 0.0F) return;
    const float inverse = 1.0F / area;
    // Rows run downwards, so the winding of the free side turns negative.
    const Shown side = area < 0.0F ? Shown::outside : Shown::inside;

    std::optional<std::array<Vec3f, 3>> normals;
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        const float px = static_cast<float>(x) + 0.5F, py = static_cast<float>(y) + 0.5F;
        const float u = ((px - x0) * (y2 - y0) - (x2 - x0) * (py - y0)) * inverse;
        const float v = ((x1 - x0) * (py - y0) - (px - x0) * (y1 - y0)) * inverse;
        const float w = 1.0F - u - v;
        if (std::min({u, v, w}) < -seam) continue;
        const float depth = w * a.z() + u * b.z() + v * c.z();
        const std::size_t i = samples_.at(x, y);
        if (depth <= samples_.depth[i] || depth > curtain_.depth(x, y)) continue;
        samples_.depth[i] = depth;
        samples_.shown[i] = side;
        if (!normals) normals = make_normals();
        samples_.normal[i] = w * (*normals)[0] + u * (*normals)[1] + v * (*normals)[2];
      }
    }
  }

  /// Where the first thing behind the cut is the back of a closed surface, the cut goes through the
  /// solid: show its flat face instead.
  void close_section() {
    for (int y = 0; y < samples_.size.height; ++y) {
      for (int x = 0; x < samples_.size.width; ++x) {
        const std::size_t i = samples_.at(x, y);
        if (samples_.shown[i] != Shown::inside) continue;
        samples_.shown[i] = Shown::section;
        samples_.depth[i] = curtain_.depth(x, y);
        samples_.normal[i] = Vec3f::UnitZ();
      }
    }
  }

 private:
  float half_width() const { return 0.5F * static_cast<float>(samples_.size.width); }
  float half_height() const { return 0.5F * static_cast<float>(samples_.size.height); }
  float column(const Vec3f& view) const { return half_width() + view.x(); }
  float row(const Vec3f& view) const { return half_height() - view.y(); }
  // The first and the last sample whose centre lies in a range; none is left where the range is
  // outside of the picture. Clamped before the conversion, as an int would overflow.
  static int first(float low, int count) {
    return static_cast<int>(
        std::ceil(std::clamp(low, 0.5F, static_cast<float>(count) + 0.5F) - 0.5F));
  }
  static int last(float high, int count) {
    return static_cast<int>(
        std::floor(std::clamp(high, -0.5F, static_cast<float>(count) - 0.5F) - 0.5F));
  }

  Samples& samples_;
  const Curtain& curtain_;
};

}  // namespace

Samples rasterize(const Mesh& mesh, const Camera& camera, ImageSize size, Interior interior) {
  Samples samples;
  samples.size = {size.width * Samples::per_pixel, size.height * Samples::per_pixel};
  const auto count = samples.at(0, samples.size.height);
  samples.shown.assign(count, Shown::nothing);
  samples.depth.assign(count, nowhere);
  samples.normal.assign(count, Vec3f::UnitZ());

  const double scale = static_cast<double>(samples.size.height) / camera.view_height;
  const std::vector<Vec3f> view = to_view(mesh, camera, scale);
  const std::vector<Vec3f> normals = smooth_normals(mesh, view);
  const Curtain curtain(camera, samples.size);
  Raster raster(samples, curtain);
  for (const Corners& corners : mesh.triangles()) {
    const Vec3f &a = view[corners[0]], &b = view[corners[1]], &c = view[corners[2]];
    raster.draw(a, b, c, [&] {
      const Vec3f flat = (b - a).cross(c - a).normalized();
      std::array<Vec3f, 3> at = {normals[corners[0]], normals[corners[1]], normals[corners[2]]};
      for (Vec3f& normal : at) {
        if (normal.dot(flat) < crease_cosine) normal = flat;
      }
      return at;
    });
  }

  if (interior == Interior::solid && camera.cut) raster.close_section();
  return samples;
}

bool sees(const Samples& samples, const Camera& camera, const Vec3& point, double slack) {
  const PicturePoint p = project(camera, samples.size, point);
  const int x = static_cast<int>(std::floor(p.x)), y = static_cast<int>(std::floor(p.y));
  if (x < 0 || y < 0 || x >= samples.size.width || y >= samples.size.height) return false;
  const double scale = static_cast<double>(samples.size.height) / camera.view_height;
  return p.depth + slack * scale >= static_cast<double>(samples.depth[samples.at(x, y)]);
}

}  // namespace keepout::app
