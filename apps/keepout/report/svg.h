// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace keepout::app {

/// The pieces that all drawings are made of. Places are in units of the view box, y downwards; the
/// page scales it to the room there is. Words are escaped here; classes are ours and are not.

/// A place, to a tenth of a unit.
std::string coordinate(double value);

/// The start tag; `description` is read out in place of the picture.
std::string open_svg(const std::string& css_class, double width, double height,
                     const std::string& description);

std::string svg_line(const std::string& css_class, double x1, double y1, double x2, double y2);

std::string svg_box(const std::string& css_class, double x, double y, double width, double height);

/// `anchor`: start, middle or end, as SVG has it.
std::string svg_text(const std::string& css_class, double x, double y, const char* anchor,
                     const std::string& words);

/// How wide words may become, at the larger letters of a small screen.
double width_of(const std::string& words);

}  // namespace keepout::app
