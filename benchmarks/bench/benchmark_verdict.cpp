// SPDX-License-Identifier: BSD-3-Clause
#include "bench/benchmark_verdict.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "shared/number_text.h"
#include "shared/used_cores.h"

namespace keepout::app {
namespace {

using Rows = std::vector<const BenchmarkRow*>;  // in their order

Rows only(const Rows& rows, const std::function<bool(const BenchmarkRow&)>& wanted) {
  Rows result;
  std::ranges::copy_if(rows, std::back_inserter(result),
                       [&](const BenchmarkRow* row) { return wanted(*row); });
  return result;
}

/// Those whose steps were timed.
Rows timed(const Benchmark& benchmark) {
  Rows rows;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (row.step) rows.push_back(&row);
  }
  return rows;
}

/// Whether all steps but one in a hundred at most have an answer: a solver that gives up may be
/// quick, but is not fast.
bool answers(const BenchmarkRow& row) { return row.unsolved_share <= 0.01; }

/// Whether at least half of the queries find a triangle: else their median is the time of finding
/// nothing, and there is nothing to keep a step from.
bool reaches(const BenchmarkRow& row) { return row.reaching_share >= 0.5; }

/// Those that may be set against each other: also, the clock saw the step take time.
Rows ranked(const Rows& rows) {
  return only(rows, [](const BenchmarkRow& row) {
    return reaches(row) && answers(row) && row.step->p50 > 0.0;
  });
}

double median(const BenchmarkRow& row) { return row.step->p50; }

bool is(const BenchmarkRow& row, const Pair& pair) {
  return row.index == pair.index && row.solver == pair.solver;
}

std::string radius_text(const std::optional<double>& radius) {
  return radius ? trimmed(*radius) + "\u00a0mm" : "as far as the motion leads";
}

/// "with a motion sphere of 5 mm"; "looking as far as the motion leads".
std::string sphere_text(const std::optional<double>& radius) {
  return (radius ? "with a motion sphere of " : "looking ") + radius_text(radius);
}

/// "bunny with 985,856 triangles"
std::string mesh_text(const BenchmarkRow& row) {
  return row.mesh + " with " + counted(row.triangles, "triangle");
}

/// "wide_bvh, paper, active_set"
std::string combination(const BenchmarkRow& row) {
  return row.index + ", " + row.activation + ", " + row.solver;
}

/// Two rows that differ in index and solver, and in nothing else.
struct Duel {
  const BenchmarkRow* ours;
  const BenchmarkRow* peers;
};

bool same_conditions(const BenchmarkRow& a, const BenchmarkRow& b) {
  return a.mesh == b.mesh && a.triangles == b.triangles && a.radius == b.radius &&
         a.activation == b.activation;
}

/// Slow parts are asked few steps; a headline wants at least so many of both.
constexpr std::size_t enough_steps = 100;

std::vector<Duel> duels(const Rows& rows) {
  std::vector<Duel> result;
  for (const BenchmarkRow* ours : rows) {
    if (!is(*ours, our_pair) || ours->queries < enough_steps) continue;
    for (const BenchmarkRow* peers : rows) {
      if (is(*peers, peer_pair) && peers->queries >= enough_steps &&
          same_conditions(*ours, *peers)) {
        result.push_back({ours, peers});
        break;
      }
    }
  }
  return result;
}

/// The duel to be told first: under the published rule where there is one, on the largest mesh,
/// with the largest sphere.
std::optional<Duel> main_duel(const std::vector<Duel>& all) {
  const auto rank = [](const Duel& duel) {
    return std::tuple(duel.ours->activation == "paper", duel.ours->triangles, duel.ours->radius);
  };
  const auto best = std::max_element(
      all.begin(), all.end(), [&](const Duel& a, const Duel& b) { return rank(a) < rank(b); });
  return best == all.end() ? std::nullopt : std::optional(*best);
}

double ratio(const BenchmarkRow& quick, const BenchmarkRow& slow) {
  return median(slow) / median(quick);
}

std::string words(const BenchmarkRow& row) { return row.index + " with " + row.solver; }

bool ahead(const Duel& duel) { return median(*duel.ours) <= median(*duel.peers); }
const BenchmarkRow& quick_of(const Duel& duel) { return ahead(duel) ? *duel.ours : *duel.peers; }
const BenchmarkRow& slow_of(const Duel& duel) { return ahead(duel) ? *duel.peers : *duel.ours; }

std::string told(const Duel& duel) {
  const BenchmarkRow& quick = quick_of(duel);
  const BenchmarkRow& slow = slow_of(duel);
  return words(quick) + " answers a step in " + time_text(median(quick)) + ", where " +
         words(slow) + " takes " + time_text(median(slow)) + ": " + ratio_text(ratio(quick, slow)) +
         " times as long.";
}

/// "Those are medians of 2,500 and 120 steps on bunny with 51,978 triangles"; of so many "each"
std::string medians(const BenchmarkRow& quick, const BenchmarkRow& slow) {
  const std::string where = " on " + mesh_text(quick);
  if (&quick == &slow) return "That is the median of " + counted(quick.queries, "step") + where;
  if (quick.queries == slow.queries) {
    return "Those are medians of " + counted(quick.queries, "step") + " each" + where;
  }
  return "Those are medians of " + grouped(quick.queries) + " and " +
         counted(slow.queries, "step") + where;
}

std::string conditions(const Duel& duel) {
  const BenchmarkRow& row = *duel.ours;
  return medians(quick_of(duel), slow_of(duel)) + ", rule " + row.activation + ", " +
         sphere_text(row.radius) + ". ";
}

/// The same duel with the other spheres.
std::string other_radii(const std::vector<Duel>& all, const Duel& main) {
  std::string text;
  for (const Duel& duel : all) {
    if (duel.ours == main.ours || duel.ours->mesh != main.ours->mesh ||
        duel.ours->triangles != main.ours->triangles ||
        duel.ours->activation != main.ours->activation) {
      continue;
    }
    const double ours = median(*duel.ours), peers = median(*duel.peers);
    text += (text.empty() ? "With a sphere of " : "; with one of ") +
            radius_text(duel.ours->radius) + " it is " + time_text(ours) + " against " +
            time_text(peers) + ", " + ratio_text(std::max(ours, peers) / std::min(ours, peers)) +
            " times as " + (ours <= peers ? "long" : "quick");
  }
  return text.empty() ? text : text + ". ";
}

/// What our pair does there under the other rules, each with the largest sphere.
std::string other_rules(const Rows& rows, const BenchmarkRow& main) {
  std::map<std::string, const BenchmarkRow*> widest;  // of each rule
  for (const BenchmarkRow* row : rows) {
    if (!is(*row, our_pair) || row->mesh != main.mesh || row->triangles != main.triangles ||
        row->activation == main.activation) {
      continue;
    }
    const BenchmarkRow*& known = widest[row->activation];
    if (known == nullptr || row->radius > known->radius) known = row;
  }
  std::string text;
  for (const auto& [rule, row] : widest) {
    text += (text.empty() ? "Under rule " : "; under rule ") + rule +
            (text.empty() ? ", the same index and solver take " : ", ") + time_text(median(*row)) +
            ", " + sphere_text(row->radius);
  }
  return text.empty() ? text : text + ". ";
}

/// The parts that are named, as they describe themselves.
std::string what_they_are(const Benchmark& benchmark, const Duel& duel) {
  std::string text;
  for (const std::string& name : {duel.ours->index, duel.ours->solver, duel.peers->index,
                                  duel.peers->solver, duel.ours->activation}) {
    const auto part = benchmark.parts.find(name);
    if (part == benchmark.parts.end()) continue;
    text += (text.empty() ? "Of the names, " : "; ") + name + " stands for \u201c" + part->second +
            "\u201d";
  }
  return text.empty() ? text : text + ". ";
}

std::string left_out(const Benchmark& benchmark) {
  const std::size_t all = benchmark.rows.size();
  const Rows rows = timed(benchmark);
  const auto of_all = [&](std::size_t count) {
    return grouped(count) + " of " + counted(all, "row") + (count == 1 ? " was" : " were");
  };
  std::string text;
  if (rows.size() < all) {
    text += of_all(all - rows.size()) + " not timed; the table of all rows says why. ";
  }
  const Rows idle = only(rows, [](const BenchmarkRow& row) { return !reaches(row); });
  if (!idle.empty()) {
    text += of_all(idle.size()) +
            " not ranked: for more than half of the motions no triangle is in reach. ";
  }
  const Rows given_up = only(rows, [](const BenchmarkRow& row) { return !answers(row); });
  if (!given_up.empty()) {
    text +=
        of_all(given_up.size()) + " not ranked: more than 1 % of the steps are without an answer. ";
  }
  return text;
}

/// The fastest and the slowest combination on the largest mesh, with the largest sphere there.
struct Extremes {
  const BenchmarkRow* quick;
  const BenchmarkRow* slow;
};

/// Precondition: there is a row.
Extremes extremes(const Rows& rows) {
  const auto place = [](const BenchmarkRow* row) { return std::pair(row->triangles, row->radius); };
  const BenchmarkRow& largest = **std::ranges::max_element(rows, {}, place);
  const Rows there = only(rows, [&](const BenchmarkRow& row) {
    return row.mesh == largest.mesh && place(&row) == place(&largest);
  });
  const auto [quick, slow] =
      std::ranges::minmax_element(there, {}, [](const BenchmarkRow* row) { return median(*row); });
  return {*quick, *slow};
}

/// A row's hash over as many steps as another made too, or a power of two fewer.
std::uint64_t hash_over(const BenchmarkRow& row, std::size_t steps) {
  return row.queries == steps ? row.hash : row.first_hashes[std::bit_width(steps) - 1];
}

}  // namespace

std::string headline(const Benchmark& benchmark) {
  const Rows all = timed(benchmark);
  if (all.empty()) return "No step was timed.";
  const Rows rows = ranked(all);
  if (rows.empty()) {
    return "No combination had triangles in reach and answered 99 % of its steps.";
  }
  if (const std::optional<Duel> duel = main_duel(duels(rows))) return told(*duel);
  const auto [quick, slow] = extremes(rows);
  const std::string first =
      "A step takes " + time_text(median(*quick)) + " with " + combination(*quick);
  if (quick == slow) return first + ".";
  return first + ", and " + time_text(median(*slow)) + " with " + combination(*slow) + ": " +
         ratio_text(ratio(*quick, *slow)) + " times as long.";
}

std::string account(const Benchmark& benchmark) {
  const Rows rows = ranked(timed(benchmark));
  std::string text;
  if (benchmark.rows.size() < benchmark.planned) {
    text = "Incomplete: it was stopped after " + grouped(benchmark.rows.size()) + " of " +
           counted(benchmark.planned, "row") + ". ";
  }
  if (const std::vector<Duel> all = duels(rows); !all.empty()) {
    const Duel main = *main_duel(all);
    text += conditions(main) + other_radii(all, main) + other_rules(rows, *main.ours) +
            what_they_are(benchmark, main);
  } else if (!rows.empty()) {
    const auto [quick, slow] = extremes(rows);
    text += medians(*quick, *slow) + ", " + sphere_text(quick->radius) + ". ";
  }
  text += left_out(benchmark);
  const std::string others = others_text(benchmark.others_cores, benchmark.machine.cores);
  if (!others.empty()) text += others + " ";
  if (!text.empty()) text.pop_back();
  return text;
}

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

}  // namespace keepout::app
