// SPDX-License-Identifier: BSD-3-Clause
#include "report/spans.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/plot.h"
#include "report/svg.h"

namespace keepout::app {
namespace {

constexpr double width = 560.0, edge = 14.0, top = 8.0;
constexpr double row_height = 42.0, mark_height = 30.0, label_height = 16.0;
constexpr double bottom = 48.0;

/// Maps values to places, by their logarithms.
class LogRuler {
 public:
  explicit LogRuler(const Spans& chart) {
    const auto take = [&](double value) {
      if (!(value > 0.0) || !std::isfinite(value)) return;
      low = std::min(low, value);
      high = std::max(high, value);
    };
    for (const double value : chart.in_range) take(value);
    for (const Span& span : chart.spans) {
      take(span.value);
      take(span.reach.value_or(0.0));
      take(span.before.value_or(0.0));
    }
    if (low > high) low = high = 1.0;  // there are no data
    low /= 1.3;
    high *= 1.3;
  }

  bool has(double value) const { return value > 0.0 && std::isfinite(value); }

  double place(double value) const {
    return edge + (width - 2.0 * edge) * std::log(value / low) / std::log(high / low);
  }

  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
};

std::string one_span(const Span& span, const LogRuler& ruler, double y) {
  std::string svg = svg_text("label", edge, y + label_height - 2.0, "start", span.label) +
                    svg_text("total", width - edge, y + label_height - 2.0, "end", span.value_text);
  const double at = y + mark_height - 3.0;
  const bool marked = ruler.has(span.value);
  if (span.reach && ruler.has(*span.reach)) {
    // Without a mark to start at, the end is all there is to show.
    const double end = ruler.place(*span.reach);
    const double start = marked ? ruler.place(span.value) : end;
    svg += svg_line("span " + span.css_class, start, at, end, at) +
           svg_line("span " + span.css_class, end, at - 4.0, end, at + 4.0);
  }
  if (span.before && ruler.has(*span.before)) {
    svg += mark_svg(Mark::ring, span.css_class, ruler.place(*span.before), at);
  }
  if (marked) svg += mark_svg(span.mark, span.css_class, ruler.place(span.value), at);
  return svg;
}

}  // namespace

std::string to_svg(const Spans& chart) {
  const LogRuler ruler(chart);
  const double floor = top + row_height * static_cast<double>(chart.spans.size());
  std::string svg = open_svg("plot", width, floor + bottom, chart.description);
  for (const double tick : logarithmic_ticks(ruler.low, ruler.high)) {
    const double x = ruler.place(tick);
    svg += svg_line("grid", x, top, x, floor) +
           svg_text("axis", x, floor + 17.0, "middle", tick_text(tick));
  }
  svg += svg_text("axis name", 0.5 * width, floor + bottom - 9.0, "middle", chart.axis);
  double y = top;
  for (const Span& span : chart.spans) {
    svg += one_span(span, ruler, y);
    y += row_height;
  }
  return svg + "</svg>";
}

}  // namespace keepout::app
