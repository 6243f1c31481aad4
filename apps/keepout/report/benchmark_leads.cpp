// SPDX-License-Identifier: BSD-3-Clause
#include "report/benchmark_leads.h"

#include <algorithm>
#include <cmath>
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

/// About as many planes: solvers that are asked for fewer motions have another mean.
bool as_many_planes(const BenchmarkRow& a, const BenchmarkRow& b) {
  return std::abs(a.planes_mean - b.planes_mean) <= 0.1 * std::max(a.planes_mean, b.planes_mean);
}

/// The rows of the problems that most solvers got with as many planes; of these those with most.
Rows hardest_problems(const Rows& rows) {
  const auto alike = [&](const BenchmarkRow& like) {
    return only(rows, [&](const BenchmarkRow& row) {
      return row.mesh == like.mesh && row.triangles == like.triangles &&
             row.radius == like.radius && as_many_planes(row, like);
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
    "No row is ranked: none has triangles in reach and an answer to 99 % of its steps";

/// The solvers that are shown, but not ranked.
std::string given_up(const Rows& rows) {
  const Rows some = only(rows, [](const BenchmarkRow& row) { return !answers(row); });
  if (some.empty()) return {};
  return " Shown, but not ranked: " + counted(some.size(), "row") + " of " +
         listed(names(some, &BenchmarkRow::solver)) +
         " with more than 1 % of the steps without an answer.";
}

/// The stage that takes most of a step, and how much of it.
std::string main_stage(const BenchmarkRow& row) {
  const std::vector<std::pair<double, const char*>> stages = {
      {row.step_query ? row.step_query->p50 : 0.0, "query"},
      {row.activate->p50, "activation"},
      {row.solve->p50, "search for the motion"}};
  double sum = 0.0;
  for (const auto& stage : stages) sum += stage.first;
  const auto& most = *std::max_element(stages.begin(), stages.end());
  if (!(sum > 0.0)) return "no stage takes any time";
  return std::string("the ") + most.second + " takes " + rounded(100.0 * most.first / sum, 2) +
         " % of the step";
}

/// Which have no query stage, and why.
std::string searching(const Rows& rows) {
  std::vector<std::string> names;
  for (const BenchmarkRow* row : rows) {
    if (!row->step_query) names.push_back(row->index + " under " + row->activation);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  if (names.empty()) return {};
  return " With " + listed(names) +
         " the rule searches the tree by itself: there is no query, its work is in the other two.";
}

std::string rate_text(const BenchmarkRow& row) { return rounded(rate_khz(row)) + "\u00a0kHz"; }

/// Three digits, the thousands set apart.
std::string grouped_digits(double value) {
  return grouped(static_cast<std::size_t>(std::stod(rounded(value))));
}

}  // namespace

std::string query_lead(const Rows& rows) {
  const Rows eligible = ranked(rows, &BenchmarkRow::query);
  if (eligible.empty()) return std::string(nobody_ranked) + ".";
  const Rows there = on_common_mesh(eligible);
  const BenchmarkRow& quick = fastest(there, &BenchmarkRow::query);
  const BenchmarkRow& slow = slowest(there, &BenchmarkRow::query);
  std::string text = "On " + mesh_text(quick) + ", " + sphere_text(quick.radius) + ", " +
                     quick.index + " finds the triangles in " +
                     time_text(median(quick, &BenchmarkRow::query));
  if (&quick != &slow) {
    text += " and " + slow.index + " in " + time_text(median(slow, &BenchmarkRow::query));
  }
  const std::string grows = growth(eligible, quick.index, &BenchmarkRow::query);
  text += grows.empty() ? "." : "; the flatter a line, the less a finer mesh costs.";
  // What an index that proposes no other triangles has decided need not be decided again, but is.
  const Rows exact =
      only(there, [](const BenchmarkRow& row) { return row.candidates_mean == row.hits_mean; });
  if (!exact.empty()) {
    text += " What " + listed(names(exact, &BenchmarkRow::index)) +
            (exact.size() > 1 ? " propose" : " proposes") +
            " are the triangles in reach and no others, so that their candidates include a test "
            "of triangles, and the query tests them once more.";
  }
  return text;
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

std::string rate_lead(const Rows& line) {
  const BenchmarkRow& small = *line.front();
  const BenchmarkRow& large = *line.back();
  std::string text = line_name(large) + ": " + rate_text(large) + " at " +
                     counted(large.triangles, "triangle") + "; ";
  const std::vector<RateCrossing> crossings = crossings_of_1_khz(line);
  const bool keeps = rate_khz(small) >= 1.0;
  if (crossings.empty()) {
    const std::string range = line.size() == 1 ? "" : " from " + grouped(small.triangles) + " on";
    return text + (keeps ? "1\u00a0kHz is kept up to there, the largest here."
                         : "1\u00a0kHz is not reached" + range + ".");
  }
  text += keeps ? "it falls below 1\u00a0kHz at about " : "it rises above 1\u00a0kHz at about ";
  const char* separator = "";
  for (const RateCrossing& crossing : crossings) {
    text += separator + grouped_digits(crossing.triangles) + " triangles, between the meshes of " +
            grouped(crossing.before->triangles) + " and " + grouped(crossing.after->triangles);
    separator = ", and crosses it again at about ";
  }
  return text + ".";
}

std::string published_lead(const std::vector<Rows>& lines) {
  return "Rates of the median step. The stars are what Li et al. 2020 published for the Stanford "
         "bunny, " +
         trimmed(published_rates.front().khz) + "\u00a0kHz at " +
         grouped(published_rates.front().triangles) + " and " +
         trimmed(published_rates.back().khz) + "\u00a0kHz at " +
         grouped(published_rates.back().triangles) +
         " triangles on an Intel i7-8700, another machine. They state neither the motions nor the "
         "motion sphere of that run; their 5\u00a0mm are those of the skull that they cut" +
         (one_size(lines) ? "." : ". Compare the slopes, not the heights.");
}

std::string solve_lead(const Rows& rows) {
  // What is told is what the plot shows.
  Rows shown;
  for (const std::string& solver : names(rows, &BenchmarkRow::solver)) {
    for (const BenchmarkRow* row : problems_of(rows, solver)) shown.push_back(row);
  }
  const Rows eligible = ranked(shown, &BenchmarkRow::solve);
  const std::string marks =
      "; rule " + rows.front()->activation + ", a mark for each mesh and radius." + given_up(rows);
  if (eligible.empty()) return std::string(nobody_ranked) + marks;
  const Rows there = hardest_problems(eligible);
  const auto told = [](const BenchmarkRow& row) {
    return row.solver + " finds the motion in " + time_text(median(row, &BenchmarkRow::solve)) +
           " among " + mean_text(row.planes_mean) + " planes in the mean";
  };
  const BenchmarkRow& quick = fastest(there, &BenchmarkRow::solve);
  const BenchmarkRow& slow = slowest(there, &BenchmarkRow::solve);
  std::string other;
  if (quick.solver != slow.solver) {
    other = " and " + told(slow);
  } else if (names(eligible, &BenchmarkRow::solver).size() > 1) {
    other = ", and no other solver was given as many";
  }
  return "On " + mesh_text(quick) + ", " + sphere_text(quick.radius) + ", " + told(quick) + other +
         marks;
}

std::string stage_lead(const Rows& rows) {
  const BenchmarkRow& quick = fastest(rows, &BenchmarkRow::step);
  const BenchmarkRow& slow = slowest(rows, &BenchmarkRow::step);
  const std::string text = "On " + mesh_text(quick) + ", " + sphere_text(quick.radius) +
                           ", in the fastest combination " + main_stage(quick);
  return text + (&quick == &slow ? "." : "; in the slowest " + main_stage(slow) + ".") +
         " Solve is the search for the motion: the solver's work and, under certified, the rule's "
         "proofs." +
         searching(rows);
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
  const auto built = [](const BenchmarkRow& row) {
    return "in " + rounded(row.build_s) + " s with " + rounded(row.build_cores, 2) + " cores busy";
  };
  const auto build = &BenchmarkRow::build_s;
  const auto memory = &BenchmarkRow::bytes_per_triangle;
  const BenchmarkRow& first = *rows.front();
  const std::string where = "On " + mesh_text(first) + ", ";
  const std::string file = ". Reading the mesh's file took " + rounded(first.load_s) + " s with " +
                           rounded(first.load_cores, 2) + " cores busy.";
  if (rows.size() == 1) {
    return where + first.index + " is built " + built(first) + ", and takes " +
           rounded(first.bytes_per_triangle) + " bytes a triangle" + file;
  }
  return where + least(build)->index + " is built fastest, " + built(*least(build)) + ", and " +
         most(build)->index + " slowest, " + built(*most(build)) + "; " + least(memory)->index +
         " takes least memory, " + rounded(least(memory)->bytes_per_triangle) +
         " bytes a triangle, and " + most(memory)->index + " most, " +
         rounded(most(memory)->bytes_per_triangle) + file;
}

}  // namespace keepout::app
