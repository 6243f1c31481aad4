// SPDX-License-Identifier: BSD-3-Clause
#include "report/histogram_plots.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "report/plot.h"

namespace keepout::app {
namespace {

double microseconds(std::size_t bin) { return 1e-3 * TimeHistogram::beginning_of(bin); }

/// From the first bin that holds something to the one after the last.
struct Range {
  std::size_t first = TimeHistogram::bins, end = 0;
};

Range range_of(const TimeHistogram& histogram) {
  Range range;
  for (std::size_t bin = 0; bin < TimeHistogram::bins; ++bin) {
    if (histogram.count(bin) == 0) continue;
    range.first = std::min(range.first, bin);
    range.end = bin + 1;
  }
  return range;
}

constexpr double below_one = 0.5;  // where a logarithmic axis shows nothing

/// A staircase: each bin at its height.
Series counts(const TimeHistogram& histogram, std::string name, std::string css_class) {
  Series series{.name = std::move(name), .css_class = std::move(css_class), .points = {}};
  const Range range = range_of(histogram);
  for (std::size_t bin = range.first; bin < range.end; ++bin) {
    const double count = std::max(static_cast<double>(histogram.count(bin)), below_one);
    series.points.push_back({microseconds(bin), count});
    series.points.push_back({microseconds(bin + 1), count});
  }
  return series;
}

Series tail(const TimeHistogram& histogram, std::string name, std::string css_class) {
  Series series{.name = std::move(name), .css_class = std::move(css_class), .points = {}};
  const Range range = range_of(histogram);
  std::uint64_t left = histogram.total();
  for (std::size_t bin = range.first; bin < range.end && left > 0; ++bin) {
    const double share = static_cast<double>(left) / static_cast<double>(histogram.total());
    series.points.push_back({microseconds(bin), 1e6 * share});
    left -= histogram.count(bin);
  }
  return series;
}

template <class MakeSeries>
Plot plot_of(const StepHistogram& histogram, const std::string& y, MakeSeries&& make) {
  return {.description = "Times of certified steps and of an empty loop: " + y,
          .x = {.label = "time, us", .scale = Axis::Scale::logarithmic},
          .y = {.label = y, .scale = Axis::Scale::logarithmic},
          .series = {make(histogram.nothing, "empty loop", "series-7"),
                     make(histogram.steps, "certified step", "series-0")},
          .bands = {},
          .markers = {}};
}

}  // namespace

std::string counts_plot(const StepHistogram& histogram) {
  Plot plot = plot_of(histogram, "cycles in a bin", counts);
  plot.y.low = below_one;
  return to_svg(plot);
}

std::string tail_plot(const StepHistogram& histogram) {
  return to_svg(plot_of(histogram, "of a million cycles, longer", tail));
}

}  // namespace keepout::app
