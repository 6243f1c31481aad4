// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace keepout::app {

/// The shape at each point of a series, so that nobody needs colours to tell series apart.
enum class Mark : std::uint8_t {
  none,
  disc,
  square,
  triangle,
  diamond,
  wedge,  // a triangle that stands on its tip
  ring,   // the same five, open
  open_square,
  open_triangle,
  open_diamond,
  open_wedge,
  star
};

/// The shape and the CSS class, which gives the colour, of the n-th series: ten of each; those
/// after the first ten pair them in another way.
Mark mark_of(std::size_t series);
std::string series_class(std::size_t series);

/// The shape around a place of the drawing.
std::string mark_svg(Mark mark, const std::string& css_class, double x, double y);

}  // namespace keepout::app
