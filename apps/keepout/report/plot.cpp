// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "report/plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "report/text.h"

namespace keepout::app {
namespace {

// The drawing, in units of its view box: the page scales it to the room there is.
constexpr double width = 560.0, height = 400.0;
constexpr double left = 66.0, right = 26.0, bottom = 52.0, legend_row = 22.0;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

std::string tick_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", std::abs(value) < 1e-12 ? 0.0 : value);
  return text;
}

bool drawable(const PlotPoint& p, const Axis& x, const Axis& y) {
  const auto fits = [](const Axis& axis, double value) {
    return std::isfinite(value) && (axis.scale == Axis::Scale::linear || value > 0.0);
  };
  return fits(x, p.x) && fits(y, p.y);
}

/// An axis with its range settled: maps values to places on the drawing.
class Ruler {
 public:
  Ruler(const Axis& axis, double data_low, double data_high, double from, double to)
      : axis_(axis), from_(from), to_(to) {
    if (!(data_low <= data_high)) data_low = data_high = 1.0;  // there are no data
    double pad = 0.04 * (data_high - data_low);
    if (pad == 0.0) pad = data_low == 0.0 ? 1.0 : 0.1 * std::abs(data_low);
    const bool log = axis.scale == Axis::Scale::logarithmic;
    low = axis.low.value_or(log ? data_low / 1.2 : data_low - pad);
    high = axis.high.value_or(log ? data_high * 1.2 : data_high + pad);
  }

  double place(double value) const {
    const double part = axis_.scale == Axis::Scale::logarithmic
                            ? std::log(value / low) / std::log(high / low)
                            : (value - low) / (high - low);
    // Far outside is far enough: a drawing program need not cope with astronomical numbers.
    return from_ + std::clamp(part, -10.0, 11.0) * (to_ - from_);
  }

  std::vector<double> ticks(int wanted) const {
    return axis_.scale == Axis::Scale::logarithmic ? logarithmic_ticks(low, high)
                                                   : linear_ticks(low, high, wanted);
  }

  double low, high;

 private:
  const Axis& axis_;
  double from_, to_;
};

struct Legend {
  std::string svg;
  double height = 0.0;
};

Legend legend(const std::vector<Series>& series) {
  Legend result;
  double x = left, y = 16.0;
  for (const Series& one : series) {
    // Wide enough for the larger letters of a small screen.
    const double wide = 34.0 + 9.6 * static_cast<double>(one.name.size());
    if (x > left && x + wide > width) {
      x = left;
      y += legend_row;
    }
    result.svg += "<g class=\"legend " + one.css_class + "\"><path d=\"M" + number(x) + "," +
                  number(y - 4.5) + "h20\"/><text x=\"" + number(x + 26.0) + "\" y=\"" + number(y) +
                  "\">" + escape(one.name) + "</text></g>";
    x += wide;
  }
  result.height = series.empty() ? 10.0 : y + 12.0;
  return result;
}

std::string line(const std::string& css_class, double x1, double y1, double x2, double y2) {
  return "<path class=\"" + css_class + "\" d=\"M" + number(x1) + "," + number(y1) + "L" +
         number(x2) + "," + number(y2) + "\"/>";
}

std::string text(const std::string& css_class, double x, double y, const char* anchor,
                 const std::string& words) {
  return "<text class=\"" + css_class + "\" x=\"" + number(x) + "\" y=\"" + number(y) +
         "\" text-anchor=\"" + anchor + "\">" + escape(words) + "</text>";
}

std::string axes(const Plot& plot, const Ruler& x, const Ruler& y, double top) {
  std::string svg;
  const double floor = height - bottom;
  for (const double tick : x.ticks(6)) {
    svg += line("grid", x.place(tick), top, x.place(tick), floor);
    svg +=
        text("axis", x.place(tick), floor + 18.0, "middle", tick_text(tick) + plot.x.tick_suffix);
  }
  for (const double tick : y.ticks(6)) {
    svg += line("grid", left, y.place(tick), width - right, y.place(tick));
    svg +=
        text("axis", left - 7.0, y.place(tick) + 4.5, "end", tick_text(tick) + plot.y.tick_suffix);
  }
  svg += text("axis name", 0.5 * (left + width - right), height - 8.0, "middle", plot.x.label);
  const double middle = 0.5 * (top + floor);
  svg += "<text class=\"axis name\" text-anchor=\"middle\" transform=\"translate(15," +
         number(middle) + ") rotate(-90)\">" + escape(plot.y.label) + "</text>";
  return svg;
}

/// The points of a series on the drawing, no more of them than it can show.
std::vector<PlotPoint> placed(const Series& series, const Plot& plot, const Ruler& x,
                              const Ruler& y) {
  std::vector<PlotPoint> points;
  for (const PlotPoint& p : series.points) {
    if (drawable(p, plot.x, plot.y)) points.push_back({x.place(p.x), y.place(p.y)});
  }
  return thin_out(points, left, width - right, static_cast<std::size_t>(width));
}

std::string curve(const Series& series, const std::vector<PlotPoint>& points) {
  std::string path;
  for (const PlotPoint& p : points) {
    path += path.empty() ? 'M' : 'L';
    path += number(p.x) + "," + number(p.y);
  }
  return "<path class=\"line " + series.css_class + "\" d=\"" + path + "\"/>";
}

/// How much of a curve lies within a box, in units of the drawing.
double covered(const std::vector<PlotPoint>& curve, const PlotPoint& low, const PlotPoint& high) {
  double sum = 0.0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    // The part of the piece that is within both ranges.
    const PlotPoint a = curve[i - 1], b = curve[i];
    double from = 0.0, to = 1.0;
    const auto clip = [&](double start, double end, double least, double most) {
      if (start == end) {
        if (start < least || start > most) to = -1.0;
        return;
      }
      const double enter = (least - start) / (end - start), leave = (most - start) / (end - start);
      from = std::max(from, std::min(enter, leave));
      to = std::min(to, std::max(enter, leave));
    };
    clip(a.x, b.x, low.x, high.x);
    clip(a.y, b.y, low.y, high.y);
    if (to > from) sum += (to - from) * std::hypot(b.x - a.x, b.y - a.y);
  }
  return sum;
}

/// Writes words where the curves leave them the most room: on one of the lines of writing, at
/// heights `rows`, the first that will do, and on that as far left as it goes.
std::string text_in_the_clear(const std::string& css_class, const std::string& words,
                              const std::vector<double>& rows,
                              const std::vector<std::vector<PlotPoint>>& curves) {
  // The larger letters of a small screen fit in as well.
  const double wide = 8.4 * static_cast<double>(words.size());
  constexpr double above = 16.0, below = 5.0, step = 8.0;
  PlotPoint best;
  double least = std::numeric_limits<double>::infinity();
  for (const double y : rows) {
    for (double x = left + 8.0; x + wide < width - right; x += step) {
      double sum = 0.0;
      for (const auto& curve : curves) {
        sum += covered(curve, {x - 6.0, y - above}, {x + wide, y + below});
      }
      if (sum < least) {
        least = sum;
        best = {x, y};
      }
    }
  }
  return text(css_class, best.x, best.y, "start", words);
}

}  // namespace

std::string to_svg(const Plot& plot) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  PlotPoint low{infinity, infinity}, high{-infinity, -infinity};
  for (const Series& series : plot.series) {
    for (const PlotPoint& p : series.points) {
      if (!drawable(p, plot.x, plot.y)) continue;
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  }
  const Legend names = legend(plot.series);
  const double top = names.height, floor = height - bottom;
  const Ruler x(plot.x, low.x, high.x, left, width - right);
  const Ruler y(plot.y, low.y, high.y, floor, top);

  std::string svg = "<svg class=\"plot\" viewBox=\"0 0 " + number(width) + " " + number(height) +
                    "\" role=\"img\" aria-label=\"" + escape(plot.description) + "\">";
  std::vector<std::vector<PlotPoint>> curves;
  for (const Series& series : plot.series) curves.push_back(placed(series, plot, x, y));
  std::string labels;  // over the curves
  for (const Band& band : plot.bands) {
    const double from = std::clamp(y.place(band.high), top, floor);
    const double to = std::clamp(y.place(band.low), top, floor);
    if (to <= from) continue;
    svg += "<rect class=\"band\" x=\"" + number(left) + "\" y=\"" + number(from) + "\" width=\"" +
           number(width - right - left) + "\" height=\"" + number(to - from) + "\"/>";
    if (to - from > 24.0) {
      const std::vector<double> rows = {to - 8.0, from + 18.0, 0.5 * (from + to) + 5.0};
      labels += text_in_the_clear("band", band.label, rows, curves);
    }
  }
  svg += axes(plot, x, y, top);
  for (const Marker& marker : plot.markers) {
    if (marker.across == Marker::Across::at_y) {
      const double at = y.place(marker.value);
      if (at < top || at > floor) continue;
      svg += line("marker", left, at, width - right, at);
      svg += text("marker", width - right - 6.0, at - 5.0, "end", marker.label);
    } else {
      const double at = x.place(marker.value);
      if (at < left || at > width - right) continue;
      svg += line("marker", at, top, at, floor);
      svg += text("marker", at - 6.0, top + 14.0, "end", marker.label);
    }
  }
  // A nested drawing cuts off what leaves the frame.
  svg += "<svg x=\"" + number(left) + "\" y=\"" + number(top) + "\" width=\"" +
         number(width - right - left) + "\" height=\"" + number(floor - top) + "\" viewBox=\"" +
         number(left) + " " + number(top) + " " + number(width - right - left) + " " +
         number(floor - top) + "\">";
  for (std::size_t i = 0; i < curves.size(); ++i) svg += curve(plot.series[i], curves[i]);
  return svg + "</svg>" + labels + names.svg + "</svg>";
}

}  // namespace keepout::app
