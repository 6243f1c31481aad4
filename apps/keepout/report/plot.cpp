// SPDX-License-Identifier: BSD-3-Clause
#include "report/plot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/label_places.h"
#include "report/svg.h"
#include "report/text.h"

namespace keepout::app {
namespace {

// The drawing, in units of its view box: the page scales it to the room there is.
constexpr double width = 560.0;
constexpr double left = 66.0, bottom = 52.0, legend_row = 22.0;
constexpr double beside_frame = 26.0;  // at the right, where no names are

/// Where the curves are drawn; its left is the same in every plot.
struct Frame {
  double right, top, floor;
  double wide() const { return right - left; }
};

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

Legend legend(const Plot& plot) {
  Legend result;
  if (plot.names == Plot::Names::at_line_ends) return {"", 14.0};
  double x = left, y = 16.0;
  for (const Series& one : plot.series) {
    // Wide enough for the larger letters of a small screen.
    const double wide = 34.0 + 9.6 / 8.4 * width_of(one.name);
    if (x > left && x + wide > width) {
      x = left;
      y += legend_row;
    }
    result.svg += "<g class=\"legend " + one.css_class + "\">";
    if (one.join == Series::Join::line) {
      result.svg += "<path d=\"M" + coordinate(x) + "," + coordinate(y - 4.5) + "h20\"/>";
    }
    result.svg += mark_svg(one.mark, one.css_class, x + 10.0, y - 4.5) +
                  svg_text("label", x + 26.0, y, "start", one.name) + "</g>";
    x += wide;
  }
  result.height = plot.series.empty() ? 10.0 : y + 12.0;
  return result;
}

/// Names at line ends are bold.
double name_width(const Series& series) { return 1.08 * width_of(series.name); }

/// Room at the right for the names of the series, at most a third of the drawing.
double right_edge(const Plot& plot) {
  if (plot.names == Plot::Names::above) return width - beside_frame;
  double widest = 0.0;
  for (const Series& series : plot.series) widest = std::max(widest, name_width(series));
  return width - std::min(24.0 + widest, 0.36 * width);
}

/// The names beside the frame, each joined to the end of its curve.
std::string names_at_ends(const Plot& plot, const std::vector<std::vector<PlotPoint>>& curves,
                          const Frame& frame) {
  constexpr double gap = 17.0;  // of the larger letters
  const double room = width - frame.right - 20.0;
  std::vector<double> ends;
  std::vector<std::size_t> named;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    if (curves[i].empty()) continue;
    ends.push_back(curves[i].back().y);
    named.push_back(i);
  }
  const std::vector<double> places = label_places(ends, gap, frame.top + 4.0, frame.floor);
  std::string svg;
  for (std::size_t k = 0; k < named.size(); ++k) {
    const Series& series = plot.series[named[k]];
    const PlotPoint end = curves[named[k]].back();
    svg += "<path class=\"leader " + series.css_class + "\" d=\"M" + coordinate(end.x) + "," +
           coordinate(end.y) + "L" + coordinate(frame.right) + "," + coordinate(end.y) + "L" +
           coordinate(frame.right + 14.0) + "," + coordinate(places[k]) + "\"/>";
    // A name that is too long is squeezed rather than cut.
    const std::string squeezed =
        name_width(series) > room
            ? " textLength=\"" + coordinate(room) + "\" lengthAdjust=\"spacingAndGlyphs\""
            : "";
    svg += "<text class=\"end " + series.css_class + "\" x=\"" + coordinate(frame.right + 18.0) +
           "\" y=\"" + coordinate(places[k] + 4.5) + "\"" + squeezed + ">" + escape(series.name) +
           "</text>";
  }
  return svg;
}

std::string axes(const Plot& plot, const Ruler& x, const Ruler& y, const Frame& frame) {
  std::string svg;
  const auto [right, top, floor] = frame;
  for (const double tick : x.ticks(6)) {
    svg += svg_line("grid", x.place(tick), top, x.place(tick), floor);
    svg += svg_text("axis", x.place(tick), floor + 18.0, "middle",
                    tick_text(tick) + plot.x.tick_suffix);
  }
  for (const double tick : y.ticks(6)) {
    svg += svg_line("grid", left, y.place(tick), right, y.place(tick));
    svg += svg_text("axis", left - 7.0, y.place(tick) + 4.5, "end",
                    tick_text(tick) + plot.y.tick_suffix);
  }
  svg += svg_text("axis name", 0.5 * (left + right), floor + bottom - 8.0, "middle", plot.x.label);
  const double middle = 0.5 * (top + floor);
  svg += "<text class=\"axis name\" text-anchor=\"middle\" transform=\"translate(13," +
         coordinate(middle) + ") rotate(-90)\">" + escape(plot.y.label) + "</text>";
  return svg;
}

/// The points of a series on the drawing, no more of them than it can show.
std::vector<PlotPoint> placed(const Series& series, const Plot& plot, const Ruler& x,
                              const Ruler& y, const Frame& frame) {
  std::vector<PlotPoint> points;
  for (const PlotPoint& p : series.points) {
    if (drawable(p, plot.x, plot.y)) points.push_back({x.place(p.x), y.place(p.y)});
  }
  return thin_out(points, left, frame.right, static_cast<std::size_t>(width));
}

std::string curve(const Series& series, const std::vector<PlotPoint>& points) {
  std::string path, marks;
  for (const PlotPoint& p : points) {
    path += path.empty() ? 'M' : 'L';
    path += coordinate(p.x) + "," + coordinate(p.y);
    marks += mark_svg(series.mark, series.css_class, p.x, p.y);
  }
  if (series.join == Series::Join::none) return marks;
  return "<path class=\"line " + series.css_class + "\" d=\"" + path + "\"/>" + marks;
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
                              const std::vector<std::vector<PlotPoint>>& curves,
                              const Frame& frame) {
  // The larger letters of a small screen fit in as well.
  const double wide = width_of(words);
  constexpr double above = 16.0, below = 5.0, step = 8.0;
  PlotPoint best;
  double least = std::numeric_limits<double>::infinity();
  for (const double y : rows) {
    for (double x = left + 8.0; x + wide < frame.right; x += step) {
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
  return svg_text(css_class, best.x, best.y, "start", words);
}

std::string across(const Marker& marker, const Ruler& x, const Ruler& y, const Frame& frame) {
  if (marker.across == Marker::Across::at_y) {
    const double at = y.place(marker.value);
    if (at < frame.top || at > frame.floor) return {};
    return svg_line("marker", left, at, frame.right, at) +
           svg_text("marker", frame.right - 6.0, at - 5.0, "end", marker.label);
  }
  const double at = x.place(marker.value);
  if (at < left || at > frame.right) return {};
  return svg_line("marker", at, frame.top, at, frame.floor) +
         svg_text("marker", at - 6.0, frame.top + 14.0, "end", marker.label);
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
  const Legend names = legend(plot);
  const Frame frame{right_edge(plot), names.height, plot.height - bottom};
  const Ruler x(plot.x, low.x, high.x, left, frame.right);
  const Ruler y(plot.y, low.y, high.y, frame.floor, frame.top);

  std::string svg = open_svg("plot", width, plot.height, plot.description);
  std::vector<std::vector<PlotPoint>> curves;
  for (const Series& series : plot.series) curves.push_back(placed(series, plot, x, y, frame));
  std::string labels;  // over the curves
  for (const Band& band : plot.bands) {
    const double from = std::clamp(y.place(band.high), frame.top, frame.floor);
    const double to = std::clamp(y.place(band.low), frame.top, frame.floor);
    if (to <= from) continue;
    svg += svg_box("band", left, from, frame.wide(), to - from);
    if (to - from > 24.0) {
      const std::vector<double> rows = {to - 8.0, from + 18.0, 0.5 * (from + to) + 5.0};
      labels += text_in_the_clear("band", band.label, rows, curves, frame);
    }
  }
  svg += axes(plot, x, y, frame);
  for (const Marker& marker : plot.markers) svg += across(marker, x, y, frame);
  // A nested drawing cuts off what leaves the frame, but for half a mark.
  const double edge = plot.names == Plot::Names::at_line_ends ? 6.0 : 0.0;
  svg += "<svg x=\"" + coordinate(left) + "\" y=\"" + coordinate(frame.top) + "\" width=\"" +
         coordinate(frame.wide() + edge) + "\" height=\"" + coordinate(frame.floor - frame.top) +
         "\" viewBox=\"" + coordinate(left) + " " + coordinate(frame.top) + " " +
         coordinate(frame.wide() + edge) + " " + coordinate(frame.floor - frame.top) + "\">";
  for (std::size_t i = 0; i < curves.size(); ++i) svg += curve(plot.series[i], curves[i]);
  svg += "</svg>";
  if (plot.names == Plot::Names::at_line_ends) labels += names_at_ends(plot, curves, frame);
  return svg + labels + names.svg + "</svg>";
}

}  // namespace keepout::app
