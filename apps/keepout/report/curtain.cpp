// SPDX-License-Identifier: BSD-3-Clause
#include "report/curtain.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout::app {
namespace {

constexpr float unknown = -std::numeric_limits<float>::infinity();

}  // namespace

Curtain::Curtain(const Camera& camera, ImageSize size)
    : at_middle_(static_cast<std::size_t>(size.width), unknown),
      middle_(0.5F * static_cast<float>(size.height)) {
  if (!camera.cut || camera.cut->path.empty()) {
    std::fill(at_middle_.begin(), at_middle_.end(), std::numeric_limits<float>::infinity());
    return;
  }
  // Seen from straight above, a hanging curtain has no front; a steep one has to do.
  const double rise = std::max(0.05, camera.cut->hang.dot(camera.up));
  slope_ = static_cast<float>(camera.cut->hang.dot(camera.toward) / rise);
  hang(camera, size);
  close_gaps();
  smooth();
}

void Curtain::hang(const Camera& camera, ImageSize size) {
  const Cut& cut = *camera.cut;
  struct Place {
    float x, depth;
  };
  const auto place = [&](std::size_t i) {
    const PicturePoint p = project(camera, size, cut.path[i]);
    const auto up = static_cast<float>(0.5 * static_cast<double>(size.height) - p.y);
    return Place{static_cast<float>(p.x), static_cast<float>(p.depth) - slope_ * up};
  };
  const auto width = static_cast<float>(at_middle_.size());
  const auto span = [&](const Place& a, const Place& b) {
    const float low = std::clamp(std::floor(std::min(a.x, b.x)), 0.0F, width);
    const float high = std::clamp(std::floor(std::max(a.x, b.x)) + 1.0F, 0.0F, width);
    for (auto x = static_cast<std::size_t>(low); x < static_cast<std::size_t>(high); ++x) {
      if (at_middle_[x] != unknown) continue;
      const float way = b.x - a.x;
      const float t = std::abs(way) < 1.0F
                          ? 0.0F
                          : std::clamp((static_cast<float>(x) + 0.5F - a.x) / way, 0.0F, 1.0F);
      at_middle_[x] = a.depth + t * (b.depth - a.depth);
    }
  };
  // Both ways from the start, so that the part of the path around it is always on the curtain.
  const std::size_t start = std::min(cut.start, cut.path.size() - 1);
  span(place(start), place(start));
  for (std::size_t k = 1; k <= std::max(start, cut.path.size() - 1 - start); ++k) {
    if (k <= start) span(place(start - k + 1), place(start - k));
    if (start + k < cut.path.size()) span(place(start + k - 1), place(start + k));
  }
  // A path that passes beside the picture leaves its nearest depth.
  if (std::all_of(at_middle_.begin(), at_middle_.end(), [](float d) { return d == unknown; })) {
    std::fill(at_middle_.begin(), at_middle_.end(), place(start).depth);
  }
}

void Curtain::close_gaps() {
  const auto known = [](float depth) { return depth != unknown; };
  const auto first = std::find_if(at_middle_.begin(), at_middle_.end(), known);
  std::fill(at_middle_.begin(), first, *first);
  for (std::size_t x = 1; x < at_middle_.size(); ++x) {
    if (at_middle_[x] == unknown) at_middle_[x] = at_middle_[x - 1];
  }
}

void Curtain::smooth() {
  constexpr std::size_t reach = 6;  // [sample]: takes the steps out, keeps the way
  const std::vector<float> sharp = at_middle_;
  for (std::size_t x = 0; x < sharp.size(); ++x) {
    const std::size_t from = x < reach ? 0 : x - reach;
    const std::size_t to = std::min(sharp.size(), x + reach + 1);
    float sum = 0.0F;
    for (std::size_t k = from; k < to; ++k) sum += sharp[k];
    at_middle_[x] = sum / static_cast<float>(to - from);
  }
}

}  // namespace keepout::app
