// SPDX-License-Identifier: BSD-3-Clause
#include "report/bars.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "number_text.h"
#include "report/svg.h"

namespace keepout::app {
namespace {

constexpr double width = 560.0, edge = 12.0;
constexpr double row_height = 44.0, bar_height = 15.0, label_height = 21.0;

double sum(const Bar& bar) { return std::accumulate(bar.parts.begin(), bar.parts.end(), 0.0); }

std::string legend(const Bars& chart, double y) {
  std::string svg;
  double x = edge;
  for (const Bars::Part& part : chart.parts) {
    svg += svg_box("bar " + part.css_class, x, y - 11.0, 14.0, 11.0) +
           svg_text("label", x + 20.0, y, "start", part.name);
    x += 44.0 + width_of(part.name);
  }
  return svg;
}

/// One bar from the left edge on; shares that have the room say how large they are.
std::string one_bar(const Bars& chart, const Bar& bar, double y, double longest) {
  const bool shares = chart.length == Bars::Length::of_share;
  const double scale = longest > 0.0 ? (width - 2.0 * edge) / longest : 0.0;
  std::string svg;
  double x = edge;
  for (std::size_t i = 0; i < std::min(bar.parts.size(), chart.parts.size()); ++i) {
    const double length = bar.parts[i] * scale;
    if (!(length > 0.0) || !std::isfinite(length)) continue;
    svg += svg_box("bar " + chart.parts[i].css_class, x, y, std::max(length, 0.8), bar_height);
    if (shares && length > 46.0) {
      svg += svg_text("share", x + 0.5 * length, y + bar_height - 3.5, "middle",
                      rounded(100.0 * bar.parts[i] / longest, 2) + " %");
    }
    x += length;
  }
  return svg;
}

}  // namespace

std::string to_svg(const Bars& chart) {
  double longest = 0.0;
  for (const Bar& bar : chart.bars) longest = std::max(longest, sum(bar));
  double y = chart.title.empty() ? 6.0 : 30.0;
  std::string svg;
  if (!chart.title.empty()) svg += svg_text("title", edge, 18.0, "start", chart.title);
  if (chart.parts.size() > 1) {
    svg += legend(chart, y + 14.0);
    y += 30.0;
  }
  for (const Bar& bar : chart.bars) {
    const bool shares = chart.length == Bars::Length::of_share;
    svg += svg_text("label", edge, y + label_height - 6.0, "start", bar.label) +
           svg_text("total", width - edge, y + label_height - 6.0, "end", bar.total) +
           one_bar(chart, bar, y + label_height, shares ? sum(bar) : longest);
    y += row_height;
  }
  return open_svg("plot", width, y + 4.0, chart.description) + svg + "</svg>";
}

}  // namespace keepout::app
