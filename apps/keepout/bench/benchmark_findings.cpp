// SPDX-License-Identifier: BSD-3-Clause
#include "bench/benchmark_findings.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "bench/used_cores.h"
#include "names.h"
#include "number_text.h"

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

/// `rows`: comparable indices, with one sphere.
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
  text += grows.empty() ? "." : ". " + grows + "; the flatter a line, the less a finer mesh costs.";
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

/// "wide_bvh, paper, active_set, r = 5 mm"
std::string line_name(const BenchmarkRow& row) {
  return combination(row) + (row.radius ? ", r = " + radius_text(row.radius) : "");
}

/// `line`: one that rate_lines() gives. Its rate, and where it passes 1 kHz.
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

/// `rows`: those of one rule and mesh.
std::string solve_lead(const Rows& rows) {
  const Rows eligible = ranked(rows, &BenchmarkRow::solve);
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

/// `rows`: those of one mesh and sphere.
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

/// `rows`: one an index, on one mesh.
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

/// A row's hash over as many steps as another made too, or a power of two fewer.
std::uint64_t hash_over(const BenchmarkRow& row, std::size_t steps) {
  return row.queries == steps ? row.hash : row.first_hashes[std::bit_width(steps) - 1];
}

/// Whether rows that differ in the index alone led to the same steps, as far as they made the same;
/// and which rows have no such other.
std::string same_steps(const Benchmark& benchmark) {
  using Problem =
      std::tuple<std::string, std::size_t, std::optional<double>, std::string, std::string>;
  std::map<Problem, Rows> groups;
  std::size_t unverified = 0, alone = 0, members = 0, compared = 0, same = 0;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (row.verified && row.queries > 0) {
      groups[{row.mesh, row.triangles, row.radius, row.activation, row.solver}].push_back(&row);
    } else {
      ++unverified;
    }
  }
  std::size_t fewest = std::numeric_limits<std::size_t>::max(), most = 0;
  for (const auto& [problem, rows] : groups) {
    if (rows.size() < 2) {
      ++alone;
      continue;
    }
    const BenchmarkRow& longest = **std::ranges::max_element(rows, {}, &BenchmarkRow::queries);
    bool all = true;
    for (const BenchmarkRow* row : rows) {
      if (row == &longest) continue;
      const std::size_t steps =
          row->queries == longest.queries ? row->queries : std::bit_floor(row->queries);
      fewest = std::min(fewest, steps);
      most = std::max(most, steps);
      all = all && hash_over(*row, steps) == hash_over(longest, steps);
    }
    members += rows.size();
    ++compared;
    same += all ? 1 : 0;
  }
  std::string text;
  if (compared > 0) {
    text = "Rows that differ in the index alone, " + grouped(members) + " in " +
           counted(compared, "group") + ", made the same steps in " + grouped(same) +
           " of them, as far as they were asked for the same, the first " +
           (fewest == most ? grouped(most) : grouped(fewest) + " to " + grouped(most)) +
           " motions.";
  }
  if (compared > 0 && alone > 0) {
    text += " Left out: " + counted(alone, "row") + " without such another.";
  }
  if (unverified > 0) text += " Left out: " + counted(unverified, "row") + " not verified.";
  return text;
}

using About = BenchmarkFinding::About;

/// Calls `find` with each mesh that the rows are on, and those of them that are on it.
template <class Find>
void for_each_mesh(const Rows& rows, Find&& find) {
  for (const std::string& mesh : names(rows, &BenchmarkRow::mesh)) find(mesh, on_mesh(rows, mesh));
}

void find_in_queries(const Benchmark& benchmark, std::vector<BenchmarkFinding>& found) {
  const Rows rows = ranked(timed(benchmark, &BenchmarkRow::query), &BenchmarkRow::query);
  for_each_mesh(rows, [&](const std::string& mesh, const Rows& there) {
    for (const std::optional<double>& sphere : radii(there)) {
      const Rows shown = comparable_indices(at_radius(there, sphere));
      found.push_back({About::queries, mesh, query_lead(shown), shown});
    }
  });
}

void find_in_rates(const Benchmark& benchmark, std::vector<BenchmarkFinding>& found) {
  const Rows rows = ranked(timed(benchmark, &BenchmarkRow::step), &BenchmarkRow::step);
  for_each_mesh(rows, [&](const std::string& mesh, const Rows& there) {
    for (const Rows& line : rate_lines(there)) {
      found.push_back({About::rates, mesh, rate_lead(line), line});
    }
  });
}

void find_in_solvers(const Benchmark& benchmark, std::vector<BenchmarkFinding>& found) {
  const Rows rows =
      comparable_solvers(only(timed(benchmark, &BenchmarkRow::solve), [](const BenchmarkRow& row) {
        return reaches(row) && row.planes_mean > 0.0;
      }));
  for_each_mesh(rows, [&](const std::string& mesh, const Rows& there) {
    Rows shown;
    for (const std::string& solver : names(there, &BenchmarkRow::solver)) {
      for (const BenchmarkRow* row : problems_of(there, solver)) shown.push_back(row);
    }
    found.push_back({About::solvers, mesh, solve_lead(shown), shown});
  });
}

void find_in_stages(const Benchmark& benchmark, std::vector<BenchmarkFinding>& found) {
  const Rows rows = ranked(timed(benchmark, &BenchmarkRow::step), &BenchmarkRow::step);
  for_each_mesh(rows, [&](const std::string& mesh, const Rows& on_this) {
    const Rows common = on_common_mesh(on_this);
    for (const std::optional<double>& sphere : radii(common)) {
      Rows there = at_radius(common, sphere);
      std::ranges::stable_sort(
          there, {}, [](const BenchmarkRow* row) { return median(*row, &BenchmarkRow::step); });
      found.push_back({About::stages, mesh, stage_lead(there), there});
    }
  });
}

void find_in_costs(const Benchmark& benchmark, std::vector<BenchmarkFinding>& found) {
  Rows rows;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (row.build_s > 0.0) rows.push_back(&row);
  }
  for_each_mesh(rows, [&](const std::string& mesh, const Rows& there) {
    Rows one_each;
    for (const BenchmarkRow* row : on_common_mesh(there)) {
      const auto is_it = [&](const BenchmarkRow* known) { return known->index == row->index; };
      if (std::ranges::none_of(one_each, is_it)) one_each.push_back(row);
    }
    std::string text = cost_lead(one_each);
    if (is_busy(benchmark.others_cores, benchmark.machine.cores)) {
      text +=
          " Others kept this machine busy: times to build include waiting for a core, and do "
          "not rank what is close.";
    }
    found.push_back({About::costs, mesh, std::move(text), one_each});
  });
}

}  // namespace

std::vector<BenchmarkFinding> findings(const Benchmark& benchmark) {
  std::vector<BenchmarkFinding> found;
  find_in_queries(benchmark, found);
  find_in_rates(benchmark, found);
  find_in_solvers(benchmark, found);
  find_in_stages(benchmark, found);
  find_in_costs(benchmark, found);
  if (std::string text = same_steps(benchmark); !text.empty()) {
    found.push_back({About::steps, "", std::move(text), {}});
  }
  return found;
}

}  // namespace keepout::app
