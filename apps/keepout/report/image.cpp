// SPDX-License-Identifier: BSD-3-Clause
#include "report/image.h"

#include <cmath>

namespace keepout::app {

Image lay_over(Image below, const Image& above) {
  for (std::size_t i = 0; i < below.rgba.size(); i += 4) {
    const double cover = above.rgba[i + 3] / 255.0;
    const double rest = below.rgba[i + 3] / 255.0 * (1.0 - cover);
    const double opacity = cover + rest;
    if (opacity == 0.0) continue;
    for (std::size_t k = i; k < i + 3; ++k) {
      const double mix = (above.rgba[k] * cover + below.rgba[k] * rest) / opacity;
      below.rgba[k] = static_cast<std::uint8_t>(std::lround(mix));
    }
    below.rgba[i + 3] = static_cast<std::uint8_t>(std::lround(255.0 * opacity));
  }
  return below;
}

}  // namespace keepout::app
