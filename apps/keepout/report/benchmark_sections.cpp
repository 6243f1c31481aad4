// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "report/benchmark_sections.h"

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "number_text.h"
#include "report/benchmark_figures.h"
#include "report/benchmark_rows.h"
#include "report/published_rate.h"
#include "report/text.h"

namespace keepout::app {
namespace {

std::vector<std::string> every(const Benchmark& benchmark, std::string BenchmarkRow::*part) {
  Rows rows;
  for (const BenchmarkRow& row : benchmark.rows) rows.push_back(&row);
  return names(rows, part);
}

void open_section(std::ostream& out, const char* title, const std::string& lead) {
  out << "<h2>" << title << "</h2>\n<p class=\"lead\">" << escape(lead) << "</p>\n";
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

/// How much slower an index gets from its smallest mesh to its largest.
std::string growth(const Rows& rows, const std::string& index) {
  const Rows own = only(rows, [&](const BenchmarkRow& row) { return row.index == index; });
  const auto [small, large] = std::minmax_element(
      own.begin(), own.end(),
      [](const BenchmarkRow* a, const BenchmarkRow* b) { return a->triangles < b->triangles; });
  if ((*small)->triangles == (*large)->triangles) return {};
  const double more =
      static_cast<double>((*large)->triangles) / static_cast<double>((*small)->triangles);
  return ratio_text(more) + " times the triangles make " + index + " take " +
         ratio_text(median(**large, &BenchmarkRow::query) / median(**small, &BenchmarkRow::query)) +
         " times as long";
}

std::string query_lead(const Rows& rows) {
  const Rows there = on_common_mesh(rows);
  const BenchmarkRow& quick = fastest(there, &BenchmarkRow::query);
  const BenchmarkRow& slow = slowest(there, &BenchmarkRow::query);
  std::string text = "On " + mesh_text(quick) + ", with " + sphere_text(quick.radius) + ", " +
                     quick.index + " finds the triangles in " +
                     time_text(median(quick, &BenchmarkRow::query));
  if (&quick != &slow) {
    text += " and " + slow.index + " in " + time_text(median(slow, &BenchmarkRow::query));
  }
  const std::string grows = growth(rows, quick.index);
  return text + (grows.empty() ? "." : "; the flatter a line, the less a finer mesh costs.");
}

std::string query_about(const Rows& rows) {
  const Rows there = on_common_mesh(rows);
  const BenchmarkRow& quick = fastest(there, &BenchmarkRow::query);
  std::string text = "Rule " + quick.activation + ". Fastest at " +
                     counted(quick.triangles, "triangle") + ": " + quick.index + ", " +
                     time_text(median(quick, &BenchmarkRow::query)) + ".";
  const std::string grows = growth(rows, quick.index);
  return grows.empty() ? text : text + " " + grows + ".";
}

/// The combinations whose rate over the size of the mesh is worth a line: ours and its peer's with
/// the largest sphere, and ours with the sphere as long as the motion; or else the fastest and the
/// slowest there are.
std::vector<Rows> rate_lines(const Rows& rows) {
  const Rows scaled = on_scaled_mesh(rows);
  std::vector<Rows> lines;
  const auto add = [&](const BenchmarkRow& like) {
    lines.push_back(only(scaled, [&](const BenchmarkRow& row) {
      return combination(row) == combination(like) && row.radius == like.radius;
    }));
  };
  for (const char* rule : {"certified", "paper"}) {
    for (const Pair& pair : {our_pair, peer_pair}) {
      const Rows own = only(
          scaled, [&](const BenchmarkRow& row) { return is(row, pair) && row.activation == rule; });
      if (own.empty()) continue;
      const std::vector<std::optional<double>> spheres = radii(own);
      for (const Rows& sphere : {at_radius(own, std::nullopt), at_radius(own, spheres.front())}) {
        const bool ours = std::string(pair.index) == our_pair.index;
        if (sphere.empty() || (!sphere.front()->radius && spheres.size() > 1 && !ours)) continue;
        if (!lines.empty() && lines.back().front() == sphere.front()) continue;
        add(*sphere.front());
      }
    }
  }
  if (lines.empty()) {
    const Rows there = on_common_mesh(scaled);
    const Rows widest = at_radius(there, radii(there).front());
    add(fastest(widest, &BenchmarkRow::step));
    if (widest.size() > 1) add(slowest(widest, &BenchmarkRow::step));
  }
  return lines;
}

std::string rate_lead(const std::vector<Rows>& lines) {
  const BenchmarkRow* best = nullptr;
  for (const Rows& line : lines) {
    const BenchmarkRow& largest = **std::max_element(
        line.begin(), line.end(),
        [](const BenchmarkRow* a, const BenchmarkRow* b) { return a->triangles < b->triangles; });
    if (best == nullptr ||
        median(largest, &BenchmarkRow::step) < median(*best, &BenchmarkRow::step)) {
      best = &largest;
    }
  }
  return "By its median step " + line_name(*best) + " makes " +
         rounded(1e3 / median(*best, &BenchmarkRow::step)) + "\u00a0kHz at " +
         counted(best->triangles, "triangle") +
         "; the stars are what Li et al. 2020 published for the Stanford bunny, " +
         trimmed(published_rates.front().khz) + "\u00a0kHz at " +
         grouped(published_rates.front().triangles) + " and " +
         trimmed(published_rates.back().khz) + "\u00a0kHz at " +
         grouped(published_rates.back().triangles) +
         " triangles on an Intel i7-8700, which is another machine: compare the slopes, not the "
         "heights.";
}

/// The rows of the problems that most solvers got; of these those with most planes.
Rows hardest_problems(const Rows& rows) {
  const auto alike = [&](const BenchmarkRow& like) {
    return only(rows, [&](const BenchmarkRow& row) {
      return row.mesh == like.mesh && row.triangles == like.triangles && row.radius == like.radius;
    });
  };
  const auto rank = [&](const BenchmarkRow& row) {
    return std::pair(names(alike(row), &BenchmarkRow::solver).size(), row.planes_mean);
  };
  return alike(**std::max_element(
      rows.begin(), rows.end(),
      [&](const BenchmarkRow* a, const BenchmarkRow* b) { return rank(*a) < rank(*b); }));
}

std::string solve_lead(const Rows& rows) {
  const Rows there = hardest_problems(rows);
  const BenchmarkRow& quick = fastest(there, &BenchmarkRow::solve);
  const BenchmarkRow& slow = slowest(there, &BenchmarkRow::solve);
  const std::string text = "With " + mean_text(quick.planes_mean) + " planes in the mean, " +
                           quick.solver + " solves in " +
                           time_text(median(quick, &BenchmarkRow::solve));
  return text +
         (quick.solver == slow.solver
              ? ""
              : " and " + slow.solver + " in " + time_text(median(slow, &BenchmarkRow::solve))) +
         "; rule " + quick.activation + ", a mark for each mesh and radius.";
}

/// The stage that takes most of a step, and how much of it.
std::string main_stage(const BenchmarkRow& row) {
  const std::vector<std::pair<double, const char*>> stages = {
      {row.query->p50, "query"}, {row.activate->p50, "activation"}, {row.solve->p50, "solver"}};
  double sum = 0.0;
  for (const auto& stage : stages) sum += stage.first;
  const auto& most = *std::max_element(stages.begin(), stages.end());
  if (!(sum > 0.0)) return "no stage takes any time";
  return std::string("the ") + most.second + " takes " + rounded(100.0 * most.first / sum, 2) +
         " % of the step";
}

std::string stage_lead(const Rows& rows) {
  const BenchmarkRow& quick = fastest(rows, &BenchmarkRow::step);
  const BenchmarkRow& slow = slowest(rows, &BenchmarkRow::step);
  const std::string text = "On " + mesh_text(quick) + ", with " + sphere_text(quick.radius) +
                           ", in the fastest combination " + main_stage(quick);
  return text + (&quick == &slow ? "." : "; in the slowest " + main_stage(slow) + ".");
}

}  // namespace

void print_query_section(std::ostream& out, const Benchmark& benchmark) {
  const std::vector<std::string> all = every(benchmark, &BenchmarkRow::index);
  const Rows rows = on_scaled_mesh(timed(benchmark, &BenchmarkRow::query));
  if (rows.empty()) return;
  const std::vector<std::optional<double>> spheres = radii(rows);
  open_section(out, "Which index finds the triangles fastest",
               query_lead(comparable_indices(at_radius(rows, spheres.front()))) +
                   (sizes(rows).size() > 1
                        ? ""
                        : " Filled: the median of the whole query, and a line to its 99 %; open: "
                          "the median without the exact test of each candidate."));
  open_panels(out, spheres.size());
  for (const std::optional<double>& sphere : spheres) {
    const Rows panel = comparable_indices(at_radius(rows, sphere));
    print_panel(out, sphere_title(sphere), query_about(panel),
                sizes(rows).size() > 1 ? query_plot(panel, all) : query_spans(panel, all));
  }
  out << "</div>\n";
}

void print_rate_section(std::ostream& out, const Benchmark& benchmark) {
  const Rows rows = timed(benchmark, &BenchmarkRow::step);
  if (rows.empty()) return;
  const std::vector<Rows> lines = rate_lines(rows);
  open_section(out, "The experiment of the paper: how often a step fits into a second",
               rate_lead(lines));
  open_panels(out, 2);
  if (std::any_of(lines.begin(), lines.end(), [](const Rows& line) { return line.size() > 1; })) {
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
  const Rows rows =
      on_common_mesh(only(timed(benchmark, &BenchmarkRow::step), [](const BenchmarkRow& row) {
        return row.query && row.activate && row.solve;
      }));
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
  const auto least = [&](double BenchmarkRow::*cost) {
    return *std::min_element(
        one_radius.begin(), one_radius.end(),
        [&](const BenchmarkRow* a, const BenchmarkRow* b) { return a->*cost < b->*cost; });
  };
  const auto most = [&](double BenchmarkRow::*cost) {
    return *std::max_element(
        one_radius.begin(), one_radius.end(),
        [&](const BenchmarkRow* a, const BenchmarkRow* b) { return a->*cost < b->*cost; });
  };
  const auto build = &BenchmarkRow::build_s;
  const auto memory = &BenchmarkRow::bytes_per_triangle;
  open_section(out, "What an index costs before the first query",
               "On " + mesh_text(*one_radius.front()) + ", " + least(build)->index +
                   " is built fastest, in " + rounded(least(build)->build_s) + " s, and " +
                   most(build)->index + " slowest, in " + rounded(most(build)->build_s) + " s; " +
                   least(memory)->index + " takes least memory, " +
                   rounded(least(memory)->bytes_per_triangle) + " bytes a triangle, and " +
                   most(memory)->index + " most, " + rounded(most(memory)->bytes_per_triangle) +
                   ".");
  open_panels(out, 2);
  print_panel(out, "Time to build", "Once for each mesh, one thread.", build_bars(one_radius));
  print_panel(out, "Memory for a triangle", "What the index holds beside the mesh.",
              memory_bars(one_radius));
  out << "</div>\n";
}

}  // namespace keepout::app
