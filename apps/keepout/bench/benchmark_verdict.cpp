// SPDX-License-Identifier: BSD-3-Clause
#include "bench/benchmark_verdict.h"

#include <algorithm>
#include <optional>
#include <tuple>
#include <vector>

#include "bench/benchmark_rows.h"
#include "bench/used_cores.h"
#include "number_text.h"

namespace keepout::app {
namespace {

constexpr Stage step = &BenchmarkRow::step;

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
  return median(slow, step) / median(quick, step);
}

std::string words(const BenchmarkRow& row) { return row.index + " with " + row.solver; }

bool ahead(const Duel& duel) { return median(*duel.ours, step) <= median(*duel.peers, step); }
const BenchmarkRow& quick_of(const Duel& duel) { return ahead(duel) ? *duel.ours : *duel.peers; }
const BenchmarkRow& slow_of(const Duel& duel) { return ahead(duel) ? *duel.peers : *duel.ours; }

std::string told(const Duel& duel) {
  const BenchmarkRow& quick = quick_of(duel);
  const BenchmarkRow& slow = slow_of(duel);
  return words(quick) + " answers a step in " + time_text(median(quick, step)) + ", where " +
         words(slow) + " takes " + time_text(median(slow, step)) + ": " +
         ratio_text(ratio(quick, slow)) + " times as long.";
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
    const double ours = median(*duel.ours, step), peers = median(*duel.peers, step);
    text += (text.empty() ? "With a sphere of " : "; with one of ") +
            radius_text(duel.ours->radius) + " it is " + time_text(ours) + " against " +
            time_text(peers) + ", " + ratio_text(std::max(ours, peers) / std::min(ours, peers)) +
            " times as " + (ours <= peers ? "long" : "quick");
  }
  return text.empty() ? text : text + ". ";
}

/// What our pair does there under the other rules, each with the largest sphere.
std::string other_rules(const Rows& rows, const BenchmarkRow& main) {
  const Rows ours = only(rows, [&](const BenchmarkRow& row) {
    return is(row, our_pair) && row.mesh == main.mesh && row.triangles == main.triangles &&
           row.activation != main.activation;
  });
  std::string text;
  for (const std::string& rule : names(ours, &BenchmarkRow::activation)) {
    const Rows under = only(ours, [&](const BenchmarkRow& row) { return row.activation == rule; });
    const BenchmarkRow& widest = *at_radius(under, radii(under).front()).front();
    text += (text.empty() ? "Under rule " : "; under rule ") + rule +
            (text.empty() ? ", the same index and solver take " : ", ") +
            time_text(median(widest, step)) + ", " + sphere_text(widest.radius);
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
  const Rows rows = timed(benchmark, step);
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

/// The fastest and the slowest combination on the mesh and with the sphere that tell most.
struct Extremes {
  const BenchmarkRow* quick;
  const BenchmarkRow* slow;
};

/// Precondition: there is a row.
Extremes extremes(const Rows& rows) {
  const Rows common = on_common_mesh(rows);
  const Rows there = at_radius(common, radii(common).front());
  return {&fastest(there, step), &slowest(there, step)};
}

}  // namespace

std::string headline(const Benchmark& benchmark) {
  const Rows all = timed(benchmark, step);
  if (all.empty()) return "No step was timed.";
  const Rows rows = ranked(all, step);
  if (rows.empty()) {
    return "No combination had triangles in reach and answered 99 % of its steps.";
  }
  if (const std::optional<Duel> duel = main_duel(duels(rows))) return told(*duel);
  const auto [quick, slow] = extremes(rows);
  const std::string first =
      "A step takes " + time_text(median(*quick, step)) + " with " + combination(*quick);
  if (quick == slow) return first + ".";
  return first + ", and " + time_text(median(*slow, step)) + " with " + combination(*slow) + ": " +
         ratio_text(ratio(*quick, *slow)) + " times as long.";
}

std::string account(const Benchmark& benchmark) {
  const Rows rows = ranked(timed(benchmark, step), step);
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

}  // namespace keepout::app
