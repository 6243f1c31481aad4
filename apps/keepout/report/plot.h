// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "report/mark.h"

namespace keepout::app {

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
};

/// Points in the order of x.
struct Series {
  enum class Join { line, none };
  std::string name;
  std::string css_class;  // gives the colour
  std::vector<PlotPoint> points;
  Mark mark = Mark::none;  // at each point
  Join join = Join::line;
};

struct Axis {
  enum class Scale { linear, logarithmic };  // the latter leaves out what is not above 0
  std::string label;                         // with the unit
  Scale scale = Scale::linear;
  std::optional<double> low = {}, high = {};  // where not given, what the data need
  std::string tick_suffix = "";               // after each number
};

/// A straight line across the plot, at one value of one axis.
struct Marker {
  enum class Across { at_x, at_y };
  Across across = Across::at_y;
  double value = 0.0;
  std::string label;
};

/// A range of y that is tinted.
struct Band {
  double low = 0.0, high = 0.0;
  std::string label;
};

struct Plot {
  enum class Names {
    above,        // in a legend
    at_line_ends  // to the right of the frame, each at the height of its last point
  };
  std::string description;  // read out in place of the picture
  Axis x, y;
  std::vector<Series> series;
  std::vector<Band> bands;
  std::vector<Marker> markers;
  Names names = Names::above;
  double height = 400.0;  // for a width of 560
};

/// An <svg> element to be put into a page that defines the classes axis, grid, band, marker,
/// legend, line, mark, leader and end, and those of the series.
std::string to_svg(const Plot& plot);

/// At most four points a column: the first, the lowest, the highest and the last, in their order.
/// The picture stays the same, and no peak is lost. `low`..`high` is the range of x.
std::vector<PlotPoint> thin_out(std::span<const PlotPoint> points, double low, double high,
                                std::size_t columns);

/// Round numbers (1, 2 or 5 times a power of ten) within a range, about as many as wanted.
std::vector<double> linear_ticks(double low, double high, int wanted);

/// Powers of ten within a range, with their 2- and 5-fold where the range is short, and only every
/// second or third of them where it is long.
std::vector<double> logarithmic_ticks(double low, double high);

/// A tick in few letters: 0.5, 200, 50k, 2M, 10⁻⁶.
std::string tick_text(double value);

}  // namespace keepout::app
