// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace keepout::app {

struct ImageSize {
  int width = 0;   // [pixel]
  int height = 0;  // [pixel]
};

/// Rows from the top; four bytes a pixel: red, green, blue (sRGB) and opacity, not multiplied in.
struct Image {
  ImageSize size;
  std::vector<std::uint8_t> rgba;

  explicit Image(ImageSize s)
      : size(s), rgba(4 * static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height)) {}

  std::uint8_t* pixel(int x, int y) noexcept { return rgba.data() + index(x, y); }
  const std::uint8_t* pixel(int x, int y) const noexcept { return rgba.data() + index(x, y); }

 private:
  std::size_t index(int x, int y) const noexcept {
    return 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                static_cast<std::size_t>(x));
  }
};

/// One picture over another of the same size.
Image lay_over(Image below, const Image& above);

}  // namespace keepout::app
