// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace keepout::app {

/// One bar, made of the parts that all bars have, one after the other.
struct Bar {
  std::string label;
  std::string total;          // written at its right end
  std::vector<double> parts;  // as many as the chart names; not below 0
};

/// Lying bars, each below its label, so that long labels meet nothing.
struct Bars {
  enum class Length {
    of_value,  // bars can be compared in length
    of_share   // each bar is as long as the others: what it is made of can be compared
  };
  struct Part {
    std::string name;
    std::string css_class;  // gives the colour
  };
  std::string title;        // above the bars; may be empty
  std::string description;  // read out in place of the picture
  std::vector<Part> parts;  // named in a legend where they are more than one
  std::vector<Bar> bars;
  Length length = Length::of_value;
};

/// An <svg> element to be put into a page that defines the classes plot, bar, share and legend, and
/// those of the parts.
std::string to_svg(const Bars& chart);

}  // namespace keepout::app
