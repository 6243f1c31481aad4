// SPDX-License-Identifier: BSD-3-Clause
#include "report/benchmark_sections.h"

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "bench/used_cores.h"
#include "number_text.h"
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
  return radius ? "Motion sphere of " + radius_text(radius) : "As far as the motion leads";
}

/// Each mesh by itself: its name, where there are several, and what `print` prints of its rows.
template <class Print>
void for_each_mesh(std::ostream& out, const Rows& rows, Print&& print) {
  const std::vector<std::string> meshes = names(rows, &BenchmarkRow::mesh);
  for (const std::string& mesh : meshes) {
    if (meshes.size() > 1) out << "<h3>" << escape(mesh) << "</h3>\n";
    print(on_mesh(rows, mesh));
  }
}

void print_lead(std::ostream& out, const std::string& text) {
  out << "<p class=\"lead\">" << escape(text) << "</p>\n";
}

}  // namespace

void print_query_section(std::ostream& out, const Benchmark& benchmark) {
  const std::vector<std::string> all = every(benchmark, &BenchmarkRow::index);
  const Rows rows = ranked(timed(benchmark, &BenchmarkRow::query), &BenchmarkRow::query);
  if (rows.empty()) return;
  open_section(out, "Which index finds the triangles fastest",
               "The same work for every index, apart from the step: all triangles where the rule "
               "looks, by the exact test, with their closest points, sorted. Candidates only is "
               "what the index proposes, before that.");
  for (const auto& [name, remark] : benchmark.remarks) print_lead(out, name + ": " + remark);
  for_each_mesh(out, rows, [&](const Rows& there) {
    const std::vector<std::optional<double>> spheres = radii(there);
    const bool is_curve = sizes(there).size() > 1;
    print_lead(out, query_lead(comparable_indices(at_radius(there, spheres.front()))) +
                        (is_curve ? ""
                                  : " Filled: the median of the whole query, and a line to its "
                                    "99 %; open: the median of the candidates only."));
    open_panels(out, is_curve ? 2 : spheres.size());
    for (const std::optional<double>& sphere : spheres) {
      const Rows panel = comparable_indices(at_radius(there, sphere));
      const auto print = [&](const std::string& title, Stage stage) {
        print_panel(out, title, query_about(panel, stage),
                    is_curve ? query_plot(panel, stage, all) : query_spans(panel, all));
      };
      print(sphere_title(sphere), &BenchmarkRow::query);
      if (is_curve) print(sphere_title(sphere) + ": candidates only", &BenchmarkRow::collect);
    }
    out << "</div>\n";
  });
}

void print_rate_section(std::ostream& out, const Benchmark& benchmark) {
  const Rows rows = ranked(timed(benchmark, &BenchmarkRow::step), &BenchmarkRow::step);
  if (rows.empty()) return;
  open_section(out, "How often a step fits into a second", published_lead(rate_lines(rows)));
  for_each_mesh(out, rows, [&](const Rows& there) {
    const std::vector<Rows> lines = rate_lines(there);
    out << "<ul class=\"lead\">\n";
    for (const Rows& line : lines) out << "<li>" << escape(rate_lead(line)) << "</li>\n";
    out << "</ul>\n";
    open_panels(out, 2);
    if (!one_size(lines)) {
      print_panel(out, "", "", rate_plot(lines, Over::triangles));
      print_panel(out, "", "", rate_plot(lines, Over::vertices));
    } else {
      print_panel(out, "On " + mesh_text(*lines.front().front()),
                  "With the published rates, which are of other meshes.", rate_spans(lines));
    }
    out << "</div>\n";
  });
}

void print_solve_section(std::ostream& out, const Benchmark& benchmark) {
  const std::vector<std::string> all = every(benchmark, &BenchmarkRow::solver);
  const Rows rows =
      comparable_solvers(only(timed(benchmark, &BenchmarkRow::solve), [](const BenchmarkRow& row) {
        return reaches(row) && row.planes_mean > 0.0;
      }));
  if (rows.empty()) return;
  open_section(out, "Which solver copes with many planes",
               "Each solver has the same motions. Planes that are not in the way are left out for "
               "one that can tell that they have no bearing on its answer.");
  for_each_mesh(out, rows, [&](const Rows& there) {
    const std::string slow = solve_plot(there, all, Percentile::p99);
    print_lead(out, solve_lead(there));
    open_panels(out, 2);
    print_panel(out, "", "", solve_plot(there, all, Percentile::median));
    if (!slow.empty()) print_panel(out, "", "", slow);
    out << "</div>\n";
  });
}

void print_stage_section(std::ostream& out, const Benchmark& benchmark) {
  const Rows rows = ranked(timed(benchmark, &BenchmarkRow::step), &BenchmarkRow::step);
  if (rows.empty()) return;
  open_section(out, "Where the time of a step goes",
               "Stages are timed in a round of their own, so that the whole step, at the right, is "
               "timed without any clock within.");
  for_each_mesh(out, rows, [&](const Rows& on_this) {
    const Rows all = on_common_mesh(on_this);
    const std::vector<std::optional<double>> spheres = radii(all);
    print_lead(out, stage_lead(neighborhood(at_radius(all, spheres.front())).rows));
    open_panels(out, spheres.size());
    for (const std::optional<double>& sphere : spheres) {
      const Rows there = at_radius(all, sphere);
      const Neighborhood shown = neighborhood(there);
      print_panel(out, sphere_title(sphere),
                  (shown.rows.size() < there.size()
                       ? combination(*shown.hub) + ", and all that differ from it in one part; "
                       : "The fastest first; ") +
                      "at the right the median of the whole step.",
                  stage_bars(shown.rows));
    }
    out << "</div>\n";
  });
}

void print_cost_section(std::ostream& out, const Benchmark& benchmark) {
  Rows rows;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (row.build_s > 0.0) rows.push_back(&row);
  }
  if (rows.empty()) return;
  open_section(out, "What an index costs before the first query",
               "Each is built once on each mesh. Cores busy are the processor's time of all "
               "threads of this process over the time on the clock, of the " +
                   counted(benchmark.machine.cores, "core") + " of this machine." +
                   (is_busy(benchmark.others_cores, benchmark.machine.cores)
                        ? " Others kept this machine busy: times to build include waiting for a "
                          "core, and do not rank what is close."
                        : ""));
  for_each_mesh(out, rows, [&](const Rows& there) {
    Rows one_each;
    for (const BenchmarkRow* row : on_common_mesh(there)) {
      const auto is_it = [&](const BenchmarkRow* known) { return known->index == row->index; };
      if (std::ranges::none_of(one_each, is_it)) one_each.push_back(row);
    }
    print_lead(out, cost_lead(one_each));
    open_panels(out, 2);
    print_panel(out, "Time to build", "At the right also the cores that it kept busy.",
                build_bars(one_each));
    print_panel(out, "Memory for a triangle", "What the index holds beside the mesh.",
                memory_bars(one_each));
    out << "</div>\n";
  });
}

}  // namespace keepout::app
