// SPDX-License-Identifier: BSD-3-Clause
#include "report/benchmark_figures.h"

#include <algorithm>
#include <utility>

#include "number_text.h"
#include "report/bars.h"
#include "report/plot.h"
#include "report/published_rate.h"
#include "report/spans.h"

namespace keepout::app {
namespace {

std::size_t place_in(const std::vector<std::string>& all, const std::string& name) {
  return static_cast<std::size_t>(std::find(all.begin(), all.end(), name) - all.begin());
}

Series series_named(const std::string& name, std::size_t number) {
  return {name, series_class(number), {}, mark_of(number)};
}

void sort_by_x(std::vector<PlotPoint>& points) {
  std::stable_sort(points.begin(), points.end(),
                   [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
}

Axis logarithmic(const std::string& label) {
  return {.label = label, .scale = Axis::Scale::logarithmic};
}

Rows sorted(Rows rows, double BenchmarkRow::*cost) {
  std::stable_sort(rows.begin(), rows.end(), [&](const BenchmarkRow* a, const BenchmarkRow* b) {
    return a->*cost < b->*cost;
  });
  return rows;
}

}  // namespace

std::string query_plot(const Rows& rows, Stage stage, const std::vector<std::string>& all) {
  Plot plot;
  plot.description = "Median time of a query against the number of triangles, for each index.";
  plot.x = logarithmic("triangles");
  plot.y = logarithmic(stage == &BenchmarkRow::query ? "query [µs]" : "candidates only [µs]");
  plot.names = Plot::Names::at_line_ends;
  for (const std::string& index : names(rows, &BenchmarkRow::index)) {
    Series series = series_named(index, place_in(all, index));
    for (const BenchmarkRow* row : rows) {
      if (row->index != index) continue;
      series.points.push_back({static_cast<double>(row->triangles), median(*row, stage)});
    }
    sort_by_x(series.points);
    plot.series.push_back(std::move(series));
  }
  return to_svg(plot);
}

std::string query_spans(const Rows& rows, const std::vector<std::string>& all) {
  Spans chart;
  chart.description = "Median time of a query and its 99 %, for each index, the fastest first.";
  chart.axis = "query [µs]";
  Rows by_time = rows;
  std::stable_sort(by_time.begin(), by_time.end(),
                   [](const BenchmarkRow* a, const BenchmarkRow* b) {
                     return median(*a, &BenchmarkRow::query) < median(*b, &BenchmarkRow::query);
                   });
  for (const BenchmarkRow* row : by_time) {
    Span span{row->index, time_text(row->query->p50), series_class(place_in(all, row->index))};
    span.value = row->query->p50;
    span.reach = row->query->p99;
    if (row->collect) span.before = row->collect->p50;
    chart.spans.push_back(std::move(span));
  }
  return to_svg(chart);
}

std::string rate_plot(const std::vector<Rows>& combinations, Over over) {
  const bool triangles = over == Over::triangles;
  Plot plot;
  plot.description = std::string("Rate of the whole step against the number of ") +
                     (triangles ? "triangles" : "vertices") +
                     ", for each combination, and as published by Li et al. 2020.";
  plot.x = logarithmic(triangles ? "triangles" : "vertices");
  plot.y = logarithmic("rate of the whole step [kHz]");
  plot.height = 480.0;
  for (const Rows& rows : combinations) {
    Series series = series_named(line_name(*rows.front()), plot.series.size());
    for (const BenchmarkRow* row : rows) {
      series.points.push_back(
          {static_cast<double>(triangles ? row->triangles : row->vertices), rate_khz(*row)});
    }
    plot.series.push_back(std::move(series));
  }
  Series published{"Li et al. 2020, their machine", "series-published", {}, Mark::star};
  for (const PublishedRate& rate : published_rates) {
    published.points.push_back(
        {static_cast<double>(triangles ? rate.triangles : rate.vertices), rate.khz});
  }
  published.join = Series::Join::none;
  plot.series.push_back(std::move(published));
  plot.markers.push_back({Marker::Across::at_y, 1.0, "1 kHz"});
  return to_svg(plot);
}

std::string rate_spans(const std::vector<Rows>& combinations) {
  Spans chart;
  chart.description =
      "Rate of the whole step, for each combination, and as published by Li et al. 2020.";
  chart.axis = "rate of the whole step [kHz]";
  const auto add = [&](const std::string& label, double khz, const std::string& css, Mark mark) {
    Span span{label, rounded(khz) + "\u00a0kHz", css, mark};
    span.value = khz;
    chart.spans.push_back(std::move(span));
  };
  for (const Rows& rows : combinations) {
    const std::size_t number = chart.spans.size();
    add(line_name(*rows.front()), rate_khz(*rows.front()), series_class(number), mark_of(number));
  }
  for (const PublishedRate& rate : published_rates) {
    add("Li et al. 2020, their machine, " + counted(rate.triangles, "triangle"), rate.khz,
        "series-published", Mark::star);
  }
  return to_svg(chart);
}

std::string solve_plot(const Rows& rows, const std::vector<std::string>& all, Percentile told) {
  Plot plot;
  const bool middle_time = told == Percentile::median;
  plot.description = std::string(middle_time ? "Median" : "99 %") +
                     " of the time of the search for the motion against the mean number of planes.";
  plot.x = logarithmic("planes (mean)");
  plot.y = logarithmic(middle_time ? "solve, median [µs]" : "solve, 99 % [µs]");
  plot.names = Plot::Names::at_line_ends;
  for (const std::string& solver : names(rows, &BenchmarkRow::solver)) {
    Series series = series_named(solver, place_in(all, solver));
    for (const BenchmarkRow* row : problems_of(rows, solver)) {
      const std::optional<double> time = middle_time ? row->solve->p50 : row->solve->p99;
      if (time) series.points.push_back({row->planes_mean, *time});
    }
    sort_by_x(series.points);
    if (!series.points.empty()) plot.series.push_back(std::move(series));
  }
  return plot.series.empty() ? "" : to_svg(plot);
}

std::string stage_bars(const Rows& rows) {
  Bars chart;
  chart.description = "Which part of the median step is which, for each combination.";
  chart.parts = {
      {"query", "stage-query"}, {"activate", "stage-activate"}, {"solve", "stage-solve"}};
  chart.length = Bars::Length::of_share;
  for (const BenchmarkRow* row : rows) {
    chart.bars.push_back(
        {combination(*row),
         time_text(row->step->p50),
         {row->step_query ? row->step_query->p50 : 0.0, row->activate->p50, row->solve->p50}});
  }
  return to_svg(chart);
}

std::string build_bars(Rows rows) {
  Bars chart;
  chart.description = "Time to build each index.";
  chart.parts = {{"build", "series-0"}};
  for (const BenchmarkRow* row : sorted(std::move(rows), &BenchmarkRow::build_s)) {
    chart.bars.push_back(
        {row->index,
         rounded(row->build_s) + "\u00a0s, " + rounded(row->build_cores, 2) + "\u00a0cores",
         {row->build_s}});
  }
  return to_svg(chart);
}

std::string memory_bars(Rows rows) {
  Bars chart;
  chart.description = "Memory that each index takes for a triangle.";
  chart.parts = {{"memory", "series-0"}};
  for (const BenchmarkRow* row : sorted(std::move(rows), &BenchmarkRow::bytes_per_triangle)) {
    chart.bars.push_back(
        {row->index, rounded(row->bytes_per_triangle) + "\u00a0B", {row->bytes_per_triangle}});
  }
  return to_svg(chart);
}

std::string line_name(const BenchmarkRow& row) {
  return combination(row) + (row.radius ? ", r = " + radius_text(row.radius) : "");
}

}  // namespace keepout::app
