// SPDX-License-Identifier: BSD-3-Clause
#include "report/tube.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout::app {
namespace {

using Vec3f = Eigen::Vector3f;

class TubeLayer {
 public:
  explicit TubeLayer(const Samples& samples)
      : samples_(samples), depth_(samples.depth.size(), nowhere), color_(samples.depth.size()) {}

  /// A cylinder with round ends, drawn as the half of it that faces the viewer: every sample within
  /// its outline gets the depth and the light of the true solid.
  void draw(const Vec3f& a, const Vec3f& b, float radius, const Tube& tube) {
    const int left = std::max(0, floor(std::min(a.x(), b.x()) - radius));
    const int right = std::min(samples_.size.width - 1, floor(std::max(a.x(), b.x()) + radius));
    const int top = std::max(0, floor(std::min(a.y(), b.y()) - radius));
    const int bottom = std::min(samples_.size.height - 1, floor(std::max(a.y(), b.y()) + radius));
    const Vec3f along = b - a;
    const float square = along.head<2>().squaredNorm();
    const Eigen::Vector2f direction = along.head<2>().normalized();
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        const Eigen::Vector2f center(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
        const float t =
            square > 0.0F
                ? std::clamp((center - a.head<2>()).dot(along.head<2>()) / square, 0.0F, 1.0F)
                : (a.z() < b.z() ? 1.0F : 0.0F);
        const Vec3f axis = a + t * along;
        const Eigen::Vector2f off = center - axis.head<2>();
        const float bulge = radius * radius - off.squaredNorm();
        if (bulge <= 0.0F) continue;
        // Lit as if the cylinder went on beyond its ends: the joints of a bent tube stay invisible.
        const Eigen::Vector2f across =
            square > 0.0F ? Eigen::Vector2f(off - off.dot(direction) * direction) : off;
        const float lift = std::sqrt(radius * radius - across.squaredNorm());
        put(samples_.at(x, y), axis.z() + std::sqrt(bulge),
            Vec3f(across.x(), -across.y(), lift) / radius, tube);
      }
    }
  }

  /// From here on, tubes cover what was drawn so far.
  void start_new_layer() { std::fill(depth_.begin(), depth_.end(), nowhere); }

  Image image() const {
    constexpr int n = Samples::per_pixel;
    Image image({samples_.size.width / n, samples_.size.height / n});
    for (int y = 0; y < image.size.height; ++y) {
      for (int x = 0; x < image.size.width; ++x) {
        std::array<int, 3> sum = {0, 0, 0};
        int covered = 0;
        for (int k = 0; k < n * n; ++k) {
          const Sample& sample = color_[samples_.at(n * x + k % n, n * y + k / n)];
          if (!sample.drawn) continue;
          ++covered;
          for (std::size_t c = 0; c < 3; ++c) sum[c] += sample.color[c];
        }
        if (covered == 0) continue;
        std::uint8_t* out = image.pixel(x, y);
        for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(sum[c] / covered);
        out[3] = static_cast<std::uint8_t>(255 * covered / (n * n));
      }
    }
    return image;
  }

 private:
  static constexpr float nowhere = -std::numeric_limits<float>::infinity();
  struct Sample {
    Rgb color = {0, 0, 0};
    bool drawn = false;
  };

  static int floor(float value) {
    return static_cast<int>(std::floor(std::clamp(value, -1e6F, 1e6F)));
  }

  void put(std::size_t i, float depth, const Vec3f& normal, const Tube& tube) {
    if (depth <= depth_[i]) return;
    if (tube.sight == Tube::Sight::hidden_by_surface && depth < samples_.depth[i]) return;
    depth_[i] = depth;
    // Rounded by light from the upper left, and rimmed, to stand out from bone of any brightness.
    static const Vec3f key = Vec3f(-0.40F, 0.55F, 0.73F).normalized();
    const float rim = normal.z() < 0.45F ? 0.45F : 1.0F;
    const float light = rim * (0.72F + 0.38F * std::max(0.0F, normal.dot(key)));
    for (std::size_t c = 0; c < 3; ++c) {
      color_[i].color[c] = static_cast<std::uint8_t>(
          std::min(255L, std::lround(light * static_cast<float>(tube.color[c]))));
    }
    color_[i].drawn = true;
  }

  const Samples& samples_;
  std::vector<float> depth_;
  std::vector<Sample> color_;
};

void draw_tube(TubeLayer& layer, const Samples& samples, const Camera& camera, const Tube& tube) {
  const float radius = static_cast<float>(tube.radius * Samples::per_pixel);
  const auto place = [&](const Vec3& point) {
    const PicturePoint p = project(camera, samples.size, point);
    return Vec3f(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.depth));
  };
  if (tube.points.empty()) return;
  Vec3f last = place(tube.points.front());
  if (tube.points.size() == 1) layer.draw(last, last, radius, tube);
  for (std::size_t i = 1; i < tube.points.size(); ++i) {
    const Vec3f next = place(tube.points[i]);
    // A slow tip leaves many points within one sample; the last one of the path always counts.
    if ((next - last).squaredNorm() < 2.0F && i + 1 < tube.points.size()) continue;
    layer.draw(last, next, radius, tube);
    last = next;
  }
}

}  // namespace

Image draw_tubes(const Samples& samples, const Camera& camera, std::span<const Tube> tubes) {
  TubeLayer layer(samples);
  for (const Tube::Sight sight : {Tube::Sight::hidden_by_surface, Tube::Sight::through_surface}) {
    layer.start_new_layer();
    for (const Tube& tube : tubes) {
      if (tube.sight == sight) draw_tube(layer, samples, camera, tube);
    }
  }
  return layer.image();
}

}  // namespace keepout::app
