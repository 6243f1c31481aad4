// SPDX-License-Identifier: BSD-3-Clause
#include "report/mark.h"

#include "report/svg.h"

namespace keepout::app {
namespace {

// Relative to the middle, of about the same area.
const char* outline(Mark mark) {
  switch (mark) {
    case Mark::none:
      return "";
    case Mark::disc:
    case Mark::ring:
      return "m-4,0a4,4 0 1 0 8,0a4,4 0 1 0 -8,0z";
    case Mark::square:
    case Mark::open_square:
      return "m-3.6,-3.6h7.2v7.2h-7.2z";
    case Mark::triangle:
    case Mark::open_triangle:
      return "m0,-5l4.6,8h-9.2z";
    case Mark::diamond:
    case Mark::open_diamond:
      return "m0,-5.2l5.2,5.2l-5.2,5.2l-5.2,-5.2z";
    case Mark::wedge:
    case Mark::open_wedge:
      return "m0,5l4.6,-8h-9.2z";
    case Mark::star:
      return "m0,-8l2,5.2l5.6,.3l-4.4,3.5l1.5,5.4l-4.7,-3.1l-4.7,3.1l1.5,-5.4l-4.4,-3.5l5.6,-.3z";
  }
  return "";
}

bool open(Mark mark) { return mark >= Mark::ring && mark <= Mark::open_wedge; }

}  // namespace

Mark mark_of(std::size_t series) {
  return static_cast<Mark>(static_cast<std::size_t>(Mark::disc) + (series + series / 10) % 10);
}

std::string series_class(std::size_t series) { return "series-" + std::to_string(series % 10); }

std::string mark_svg(Mark mark, const std::string& css_class, double x, double y) {
  if (mark == Mark::none) return {};
  return std::string("<path class=\"mark ") + (open(mark) ? "open " : "") + css_class + "\" d=\"M" +
         coordinate(x) + "," + coordinate(y) + outline(mark) + "\"/>";
}

}  // namespace keepout::app
