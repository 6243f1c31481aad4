// SPDX-License-Identifier: BSD-3-Clause
#include "report/shading.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace keepout::app {
namespace {

using Vec3f = Eigen::Vector3f;
using Color = Eigen::Array3f;  // linear light

const Color bone{0.80F, 0.69F, 0.52F};
const Color hollow{0.34F, 0.20F, 0.15F};
const Color section{0.88F, 0.62F, 0.42F};
const Color section_edge{0.20F, 0.09F, 0.05F};

/// How open to the sky each pixel is, in [0, 1], for a neighbourhood of one size.
class Openness {
 public:
  Openness(const Samples& samples, float radius) : samples_(samples), radius_(radius) {
    for (std::size_t i = 0; i < taps_.size(); ++i) {
      // A golden-angle spiral covers the disc evenly with any number of taps.
      const float reach = std::sqrt((static_cast<float>(i) + 0.5F) / static_cast<float>(tap_count));
      const float angle = 2.39996F * static_cast<float>(i);
      taps_[i] = {radius * reach * std::cos(angle), radius * reach * std::sin(angle)};
    }
  }

  float operator()(int x, int y) const {
    const std::size_t here = samples_.at(x, y);
    const Vec3f normal = samples_.normal[here];
    const float depth = samples_.depth[here];
    // The spiral turns from pixel to pixel, which trades bands for noise; the blur takes the noise.
    const float turn = 0.7854F * static_cast<float>((x / 2 + 3 * (y / 2)) % 8);
    const float c = std::cos(turn), s = std::sin(turn);
    float hidden = 0.0F;
    for (const auto& [tap_x, tap_y] : taps_) {
      const int nx = x + static_cast<int>(std::lround(c * tap_x - s * tap_y));
      const int ny = y + static_cast<int>(std::lround(s * tap_x + c * tap_y));
      if (nx < 0 || ny < 0 || nx >= samples_.size.width || ny >= samples_.size.height) continue;
      const std::size_t there = samples_.at(nx, ny);
      if (samples_.shown[there] == Shown::nothing) continue;
      const Vec3f way(static_cast<float>(nx - x), static_cast<float>(y - ny),
                      samples_.depth[there] - depth);
      const float length = way.norm();
      if (length == 0.0F) continue;
      const float rise = way.dot(normal) / length;
      // What stands far in front is another part of the anatomy: it casts no shade this deep.
      const float fade = std::max(0.0F, 1.0F - length / (5.0F * radius_));
      hidden += std::max(0.0F, rise - 0.12F) * fade;
    }
    return std::max(0.0F, 1.0F - 1.9F * hidden / static_cast<float>(tap_count));
  }

 private:
  static constexpr int tap_count = 14;
  const Samples& samples_;
  float radius_;
  std::array<std::pair<float, float>, tap_count> taps_;
};

/// Means over squares of 2 * reach + 1 pixels, leaving out what is not near in depth, so that a
/// hollow does not leak over the rim in front of it.
std::vector<float> blur(const std::vector<float>& values, const std::vector<float>& depth,
                        ImageSize size, float depth_limit) {
  constexpr int reach = 2;
  std::vector<float> result(values.size(), 1.0F);
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
           static_cast<std::size_t>(x);
  };
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      float sum = 0.0F, count = 0.0F;
      const float here = depth[at(x, y)];
      if (!std::isfinite(here)) continue;
      for (int ny = std::max(0, y - reach); ny <= std::min(size.height - 1, y + reach); ++ny) {
        for (int nx = std::max(0, x - reach); nx <= std::min(size.width - 1, x + reach); ++nx) {
          if (!(std::abs(depth[at(nx, ny)] - here) < depth_limit)) continue;
          sum += values[at(nx, ny)];
          count += 1.0F;
        }
      }
      result[at(x, y)] = sum / count;
    }
  }
  return result;
}

/// Fine creases and broad hollows, pixel by pixel.
std::vector<float> ambient_light(const Samples& samples, ImageSize size) {
  const float height = static_cast<float>(samples.size.height);
  const Openness fine(samples, 0.012F * height), broad(samples, 0.07F * height);
  std::vector<float> light, depth;
  light.reserve(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
  depth.reserve(light.capacity());
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int sx = x * Samples::per_pixel, sy = y * Samples::per_pixel;
      const bool lit = samples.shown[samples.at(sx, sy)] == Shown::outside ||
                       samples.shown[samples.at(sx, sy)] == Shown::inside;
      light.push_back(lit ? fine(sx, sy) * broad(sx, sy) : 1.0F);
      depth.push_back(samples.depth[samples.at(sx, sy)]);
    }
  }
  return blur(light, depth, size, 0.01F * height);
}

Color lit(const Color& material, const Vec3f& normal, float ambient) {
  static const Vec3f key = Vec3f(-0.45F, 0.62F, 0.64F).normalized();
  static const Vec3f fill = Vec3f(0.75F, -0.10F, 0.65F).normalized();
  static const Vec3f half_way = (key + Vec3f::UnitZ()).normalized();
  const Color warm{1.00F, 0.96F, 0.89F}, cool{0.86F, 0.91F, 1.00F};
  // Wrapped a little beyond the terminator, as light in bone is.
  const float key_light = std::max(0.0F, (normal.dot(key) + 0.15F) / 1.15F);
  const float fill_light = std::max(0.0F, normal.dot(fill));
  const float sky = 0.5F + 0.5F * normal.y();
  const float gloss = std::pow(std::max(0.0F, normal.dot(half_way)), 40.0F);
  const float direct = 0.35F + 0.65F * ambient;
  return material * (warm * (0.86F * key_light * direct) + cool * (0.15F * fill_light * direct) +
                     cool * (0.09F + 0.13F * sky) * ambient) +
         warm * (0.05F * gloss * direct);
}

/// A section is drawn as a draughtsman does: flat, hatched, with a firm edge.
Color section_color(const Samples& samples, int x, int y) {
  constexpr int edge = 4, period = 52, line = 6;  // [sample]
  for (const auto& [dx, dy] : {std::pair{edge, 0}, {-edge, 0}, {0, edge}, {0, -edge}}) {
    const int nx = x + dx, ny = y + dy;
    if (nx < 0 || ny < 0 || nx >= samples.size.width || ny >= samples.size.height) continue;
    if (samples.shown[samples.at(nx, ny)] != Shown::section) return section_edge;
  }
  return (x + y) % period < line ? Color(0.80F * section) : section;
}

std::uint8_t to_srgb(float linear) {
  return static_cast<std::uint8_t>(
      std::lround(255.0F * std::pow(std::clamp(linear, 0.0F, 1.0F), 1.0F / 2.2F)));
}

}  // namespace

Image shade(const Samples& samples) {
  constexpr int n = Samples::per_pixel;
  Image image({samples.size.width / n, samples.size.height / n});
  const std::vector<float> ambient = ambient_light(samples, image.size);
  std::size_t pixel = 0;
  for (int y = 0; y < image.size.height; ++y) {
    for (int x = 0; x < image.size.width; ++x, ++pixel) {
      Color sum = Color::Zero();
      int covered = 0;
      for (int k = 0; k < n * n; ++k) {
        const int sx = n * x + k % n, sy = n * y + k / n;
        const std::size_t i = samples.at(sx, sy);
        const Shown shown = samples.shown[i];
        if (shown == Shown::nothing) continue;
        ++covered;
        if (shown == Shown::section) {
          sum += section_color(samples, sx, sy);
        } else {
          const float side = shown == Shown::outside ? 1.0F : -1.0F;
          const Vec3f normal = side * samples.normal[i].normalized();
          sum += lit(shown == Shown::outside ? bone : hollow, normal, ambient[pixel]);
        }
      }
      if (covered == 0) continue;
      const Color mean = sum / static_cast<float>(covered);
      std::uint8_t* out = image.pixel(x, y);
      for (int k = 0; k < 3; ++k) out[k] = to_srgb(mean[k]);
      out[3] = static_cast<std::uint8_t>(255 * covered / (n * n));
    }
  }
  return image;
}

}  // namespace keepout::app
