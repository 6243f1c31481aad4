// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "report/benchmark_leads.h"

#include <algorithm>
#include <utility>

#include "number_text.h"
#include "report/benchmark_figures.h"
#include "report/published_rate.h"
#include "report/text.h"

namespace keepout::app {
namespace {

/// How much slower an index gets from its smallest mesh to its largest.
std::string growth(const Rows& rows, const std::string& index, Stage stage) {
  const Rows own = only(rows, [&](const BenchmarkRow& row) { return row.index == index; });
  const auto [small, large] = std::minmax_element(
      own.begin(), own.end(),
      [](const BenchmarkRow* a, const BenchmarkRow* b) { return a->triangles < b->triangles; });
  if ((*small)->triangles == (*large)->triangles) return {};
  const double more =
      static_cast<double>((*large)->triangles) / static_cast<double>((*small)->triangles);
  return ratio_text(more) + " times the triangles make " + index + " take " +
         ratio_text(median(**large, stage) / median(**small, stage)) + " times as long";
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

/// Instead of a ranking, where no row is fit for one.
constexpr const char* nobody_ranked =
    "No row is ranked: none has an answer to 99 % of its steps in a time that can be measured";

/// The solvers that are shown, but not ranked.
std::string given_up(const Rows& rows) {
  const Rows some = only(rows, [](const BenchmarkRow& row) { return !answers(row); });
  if (some.empty()) return {};
  return " Not ranked where more than 1 % of the steps are without an answer: " +
         listed(names(some, &BenchmarkRow::solver)) + ".";
}

/// The stage that takes most of a step, and how much of it.
std::string main_stage(const BenchmarkRow& row) {
  const std::vector<std::pair<double, const char*>> stages = {
      {row.query->p50, "query"},
      {row.activate->p50, "activation"},
      {row.solve->p50, "search for the motion"}};
  double sum = 0.0;
  for (const auto& stage : stages) sum += stage.first;
  const auto& most = *std::max_element(stages.begin(), stages.end());
  if (!(sum > 0.0)) return "no stage takes any time";
  return std::string("the ") + most.second + " takes " + rounded(100.0 * most.first / sum, 2) +
         " % of the step";
}

}  // namespace

std::string query_lead(const Rows& rows) {
  const Rows eligible = ranked(rows, &BenchmarkRow::query);
  if (eligible.empty()) return std::string(nobody_ranked) + ".";
  const Rows there = on_common_mesh(eligible);
  const BenchmarkRow& quick = fastest(there, &BenchmarkRow::query);
  const BenchmarkRow& slow = slowest(there, &BenchmarkRow::query);
  std::string text = "On " + mesh_text(quick) + ", with " + sphere_text(quick.radius) + ", " +
                     quick.index + " finds the triangles in " +
                     time_text(median(quick, &BenchmarkRow::query));
  if (&quick != &slow) {
    text += " and " + slow.index + " in " + time_text(median(slow, &BenchmarkRow::query));
  }
  const std::string grows = growth(eligible, quick.index, &BenchmarkRow::query);
  return text + (grows.empty() ? "." : "; the flatter a line, the less a finer mesh costs.");
}

std::string query_about(const Rows& rows, Stage stage) {
  const Rows eligible = ranked(rows, stage);
  if (eligible.empty()) return std::string(nobody_ranked) + ".";
  const Rows there = on_common_mesh(eligible);
  const BenchmarkRow& quick = fastest(there, stage);
  std::string text = "Rule " + quick.activation + ". Fastest at " +
                     counted(quick.triangles, "triangle") + ": " + quick.index + ", " +
                     time_text(median(quick, stage)) + ".";
  const std::string grows = growth(eligible, quick.index, stage);
  return grows.empty() ? text : text + " " + grows + ".";
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
         " triangles on an Intel i7-8700, which is another machine" +
         (one_size(lines) ? "." : ": compare the slopes, not the heights.");
}

std::string solve_lead(const Rows& rows) {
  const Rows eligible = ranked(rows, &BenchmarkRow::solve);
  const std::string marks =
      "; rule " + rows.front()->activation + ", a mark for each mesh and radius." + given_up(rows);
  if (eligible.empty()) return std::string(nobody_ranked) + marks;
  const Rows there = hardest_problems(eligible);
  const BenchmarkRow& quick = fastest(there, &BenchmarkRow::solve);
  const BenchmarkRow& slow = slowest(there, &BenchmarkRow::solve);
  const std::string text = "With " + mean_text(quick.planes_mean) + " planes in the mean, " +
                           quick.solver + " finds the motion in " +
                           time_text(median(quick, &BenchmarkRow::solve));
  return text +
         (quick.solver == slow.solver
              ? ""
              : " and " + slow.solver + " in " + time_text(median(slow, &BenchmarkRow::solve))) +
         marks;
}

std::string stage_lead(const Rows& rows) {
  const BenchmarkRow& quick = fastest(rows, &BenchmarkRow::step);
  const BenchmarkRow& slow = slowest(rows, &BenchmarkRow::step);
  const std::string text = "On " + mesh_text(quick) + ", with " + sphere_text(quick.radius) +
                           ", in the fastest combination " + main_stage(quick);
  return text + (&quick == &slow ? "." : "; in the slowest " + main_stage(slow) + ".") +
         " Solve is the search for the motion: the solver's work and, under certified, the rule's "
         "proofs.";
}

std::string cost_lead(const Rows& rows) {
  const auto least = [&](double BenchmarkRow::*cost) {
    return *std::min_element(
        rows.begin(), rows.end(),
        [&](const BenchmarkRow* a, const BenchmarkRow* b) { return a->*cost < b->*cost; });
  };
  const auto most = [&](double BenchmarkRow::*cost) {
    return *std::max_element(
        rows.begin(), rows.end(),
        [&](const BenchmarkRow* a, const BenchmarkRow* b) { return a->*cost < b->*cost; });
  };
  const auto build = &BenchmarkRow::build_s;
  const auto memory = &BenchmarkRow::bytes_per_triangle;
  return "On " + mesh_text(*rows.front()) + ", " + least(build)->index + " is built fastest, in " +
         rounded(least(build)->build_s) + " s, and " + most(build)->index + " slowest, in " +
         rounded(most(build)->build_s) + " s; " + least(memory)->index + " takes least memory, " +
         rounded(least(memory)->bytes_per_triangle) + " bytes a triangle, and " +
         most(memory)->index + " most, " + rounded(most(memory)->bytes_per_triangle) + ".";
}

}  // namespace keepout::app
