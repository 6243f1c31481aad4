// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace keepout::app {

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
};

/// Points in the order of x, joined by a line.
struct Series {
  std::string name;
  std::string css_class;  // gives the colour: var(--ink)
  std::vector<PlotPoint> points;
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
  std::string description;  // read out in place of the picture
  Axis x, y;
  std::vector<Series> series;
  std::vector<Band> bands;
  std::vector<Marker> markers;
};

/// An <svg> element to be put into a page that defines the classes axis, grid, band, marker, legend
/// and line, and those of the series.
std::string to_svg(const Plot& plot);

/// At most four points a column: the first, the lowest, the highest and the last, in their order.
/// The picture stays the same, and no peak is lost. `low`..`high` is the range of x.
std::vector<PlotPoint> thin_out(std::span<const PlotPoint> points, double low, double high,
                                std::size_t columns);

/// Round numbers (1, 2 or 5 times a power of ten) within a range, about as many as wanted.
std::vector<double> linear_ticks(double low, double high, int wanted);

/// Powers of ten within a range, with their 2- and 5-fold where the range is short.
std::vector<double> logarithmic_ticks(double low, double high);

}  // namespace keepout::app
