// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "report/benchmark_sections.h"

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "report/benchmark_figures.h"
#include "report/benchmark_leads.h"
#include "report/benchmark_rows.h"
#include "report/page.h"
#include "report/text.h"

namespace keepout::app {
namespace {

std::vector<std::string> every(const Benchmark& benchmark, std::string BenchmarkRow::*part) {
  Rows rows;
  for (const BenchmarkRow& row : benchmark.rows) rows.push_back(&row);
  return names(rows, part);
}

void open_panels(std::ostream& out, std::size_t count) {
  out << "<div class=\"panels wide charts\" style=\"--columns:" << std::min<std::size_t>(count, 2)
      << "\">\n";
}

void print_panel(std::ostream& out, const std::string& name, const std::string& about,
                 const std::string& picture) {
  out << "<figure class=\"measured\">";
  if (!name.empty()) {
    out << "<figcaption><span class=\"name\">" << escape(name)
        << "</span><br><span class=\"about\">" << escape(about) << "</span></figcaption>";
  }
  out << picture << "</figure>\n";
}

std::string sphere_title(const std::optional<double>& radius) {
  return "Motion sphere " + (radius ? "of " + radius_text(radius) : radius_text(radius));
}

}  // namespace

void print_query_section(std::ostream& out, const Benchmark& benchmark) {
  const std::vector<std::string> all = every(benchmark, &BenchmarkRow::index);
  const Rows rows = on_scaled_mesh(timed(benchmark, &BenchmarkRow::query));
  if (rows.empty()) return;
  const std::vector<std::optional<double>> spheres = radii(rows);
  const bool is_curve = sizes(rows).size() > 1;
  open_section(
      out, "Which index finds the triangles fastest",
      query_lead(comparable_indices(at_radius(rows, spheres.front()))) +
          (is_curve ? " The candidates only are the index's own work; the rest of the query is "
                      "the exact test of each, which is the same for all."
                    : " Filled: the median of the whole query, and a line to its 99 %; open: "
                      "the median without the exact test of each candidate."));
  open_panels(out, is_curve ? 2 : spheres.size());
  for (const std::optional<double>& sphere : spheres) {
    const Rows panel = comparable_indices(at_radius(rows, sphere));
    const auto print = [&](const std::string& title, Stage stage) {
      print_panel(out, title, query_about(panel, stage),
                  is_curve ? query_plot(panel, stage, all) : query_spans(panel, all));
    };
    print(sphere_title(sphere), &BenchmarkRow::query);
    const bool has_both = std::ranges::all_of(
        panel, [](const BenchmarkRow* row) { return row->collect.has_value(); });
    if (is_curve && has_both) {
      print(sphere_title(sphere) + ": candidates only", &BenchmarkRow::collect);
    }
  }
  out << "</div>\n";
}

void print_rate_section(std::ostream& out, const Benchmark& benchmark) {
  const Rows rows = ranked(timed(benchmark, &BenchmarkRow::step), &BenchmarkRow::step);
  if (rows.empty()) return;
  const std::vector<Rows> lines = rate_lines(rows);
  open_section(out, "The experiment of the paper: how often a step fits into a second",
               rate_lead(lines));
  open_panels(out, 2);
  if (!one_size(lines)) {
    print_panel(out, "", "", rate_plot(lines, Over::triangles));
    print_panel(out, "", "", rate_plot(lines, Over::vertices));
  } else {
    print_panel(out, "On " + mesh_text(*lines.front().front()),
                "With the published rates, which are of other meshes.", rate_spans(lines));
  }
  out << "</div>\n";
}

void print_solve_section(std::ostream& out, const Benchmark& benchmark) {
  const std::vector<std::string> all = every(benchmark, &BenchmarkRow::solver);
  const Rows rows =
      comparable_solvers(only(timed(benchmark, &BenchmarkRow::solve),
                              [](const BenchmarkRow& row) { return row.planes_mean > 0.0; }));
  if (rows.empty()) return;
  const std::string slow = solve_plot(rows, all, Percentile::p99);
  open_section(out, "Which solver copes with many planes", solve_lead(rows));
  open_panels(out, 2);
  print_panel(out, "", "", solve_plot(rows, all, Percentile::median));
  if (!slow.empty()) print_panel(out, "", "", slow);
  out << "</div>\n";
}

void print_stage_section(std::ostream& out, const Benchmark& benchmark) {
  const Rows eligible = ranked(timed(benchmark, &BenchmarkRow::step), &BenchmarkRow::step);
  const Rows rows = on_common_mesh(only(
      eligible, [](const BenchmarkRow& row) { return row.query && row.activate && row.solve; }));
  if (rows.empty()) return;
  const std::vector<std::optional<double>> spheres = radii(rows);
  open_section(out, "Where the time of a step goes",
               stage_lead(neighborhood(at_radius(rows, spheres.front())).rows));
  open_panels(out, spheres.size());
  for (const std::optional<double>& sphere : spheres) {
    const Rows there = at_radius(rows, sphere);
    const Neighborhood shown = neighborhood(there);
    print_panel(out, sphere_title(sphere),
                (shown.rows.size() < there.size()
                     ? combination(*shown.hub) + ", and all that differ from it in one part; "
                     : "The fastest first; ") +
                    "at the right the median of the whole step.",
                stage_bars(shown.rows));
  }
  out << "</div>\n";
}

void print_cost_section(std::ostream& out, const Benchmark& benchmark) {
  Rows rows;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (row.build_s > 0.0) rows.push_back(&row);
  }
  if (rows.empty()) return;
  rows = on_common_mesh(rows);
  const Rows one_radius = comparable_indices(at_radius(rows, radii(rows).front()));
  open_section(out, "What an index costs before the first query", cost_lead(one_radius));
  open_panels(out, 2);
  print_panel(out, "Time to build",
              "Once for each mesh. Embree builds with all cores, the others with one.",
              build_bars(one_radius));
  print_panel(out, "Memory for a triangle", "What the index holds beside the mesh.",
              memory_bars(one_radius));
  out << "</div>\n";
}

}  // namespace keepout::app
