// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/mark.h"

namespace keepout::app {

/// A value and how far it reaches, such as a median and the 99 %, on an axis shared with others.
struct Span {
  std::string label;
  std::string value_text;  // written at the right end
  std::string css_class;   // gives the colour
  Mark mark = Mark::disc;
  double value = 0.0;
  std::optional<double> reach = {};   // a line leads there
  std::optional<double> before = {};  // a part of the value, as an open mark: what came first
};

/// Values from the very small to the very large: on a logarithmic axis no bar could start at zero,
/// so there are marks instead. What is not above 0 has a label and no mark.
struct Spans {
  std::string description;  // read out in place of the picture
  std::string axis;         // with the unit
  std::vector<Span> spans;
  std::vector<double> in_range = {};  // values that the axis has even if no span does
};

/// An <svg> element to be put into a page that defines the classes plot, axis, grid, span, mark and
/// total, and those of the spans.
std::string to_svg(const Spans& chart);

}  // namespace keepout::app
