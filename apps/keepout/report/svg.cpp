// SPDX-License-Identifier: BSD-3-Clause
#include "report/svg.h"

#include <algorithm>
#include <cstdio>

#include "report/text.h"

namespace keepout::app {

std::string coordinate(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

std::string open_svg(const std::string& css_class, double width, double height,
                     const std::string& description) {
  return "<svg class=\"" + css_class + "\" viewBox=\"0 0 " + coordinate(width) + " " +
         coordinate(height) + "\" role=\"img\" aria-label=\"" + escape(description) + "\">";
}

std::string svg_line(const std::string& css_class, double x1, double y1, double x2, double y2) {
  return "<path class=\"" + css_class + "\" d=\"M" + coordinate(x1) + "," + coordinate(y1) + "L" +
         coordinate(x2) + "," + coordinate(y2) + "\"/>";
}

std::string svg_box(const std::string& css_class, double x, double y, double width, double height) {
  return "<rect class=\"" + css_class + "\" x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) +
         "\" width=\"" + coordinate(width) + "\" height=\"" + coordinate(height) + "\"/>";
}

std::string svg_text(const std::string& css_class, double x, double y, const char* anchor,
                     const std::string& words) {
  return "<text class=\"" + css_class + "\" x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) +
         "\" text-anchor=\"" + anchor + "\">" + escape(words) + "</text>";
}

double width_of(const std::string& words) {
  // Bytes that continue a character of UTF-8 have no width.
  const auto characters = std::count_if(words.begin(), words.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  });
  return 8.4 * static_cast<double>(characters);
}

}  // namespace keepout::app
