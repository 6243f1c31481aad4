// SPDX-License-Identifier: BSD-3-Clause
#include "bench/benchmark_rows.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "number_text.h"

namespace keepout::app {
namespace {

/// The first of the keys that most rows, counted as `what` counts them, have. Rows that count as
/// equal count once.
template <class Key, class What>
Key most_common(const Rows& rows, Key (*key)(const BenchmarkRow&), What what) {
  std::vector<Key> order;
  std::map<Key, std::set<decltype(what(*rows.front()))>> counts;
  for (const BenchmarkRow* row : rows) {
    if (!counts.contains(key(*row))) order.push_back(key(*row));
    counts[key(*row)].insert(what(*row));
  }
  return *std::max_element(order.begin(), order.end(), [&](const Key& a, const Key& b) {
    return counts[a].size() < counts[b].size();
  });
}

std::string rule_of(const BenchmarkRow& row) { return row.activation; }
std::string solver_of(const BenchmarkRow& row) { return row.solver; }

bool faster(const BenchmarkRow& a, const BenchmarkRow& b, Stage stage) {
  return median(a, stage) < median(b, stage);
}

}  // namespace

Rows timed(const Benchmark& benchmark, Stage stage) {
  Rows rows;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (row.*stage) rows.push_back(&row);
  }
  return rows;
}

bool answers(const BenchmarkRow& row) { return row.unsolved_share <= 0.01; }

bool reaches(const BenchmarkRow& row) { return row.reaching_share >= 0.5; }

Rows ranked(const Rows& rows, Stage stage) {
  return only(rows, [&](const BenchmarkRow& row) {
    return reaches(row) && answers(row) && median(row, stage) > 0.0;
  });
}

Rows only(const Rows& rows, const std::function<bool(const BenchmarkRow&)>& wanted) {
  Rows result;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(result),
               [&](const BenchmarkRow* row) { return wanted(*row); });
  return result;
}

double median(const BenchmarkRow& row, Stage stage) { return (row.*stage)->p50; }

const BenchmarkRow& fastest(const Rows& rows, Stage stage) {
  return **std::min_element(
      rows.begin(), rows.end(),
      [&](const BenchmarkRow* a, const BenchmarkRow* b) { return faster(*a, *b, stage); });
}

const BenchmarkRow& slowest(const Rows& rows, Stage stage) {
  return **std::max_element(
      rows.begin(), rows.end(),
      [&](const BenchmarkRow* a, const BenchmarkRow* b) { return faster(*a, *b, stage); });
}

std::vector<std::string> names(const Rows& rows, std::string BenchmarkRow::*part) {
  std::vector<std::string> result;
  for (const BenchmarkRow* row : rows) {
    if (std::find(result.begin(), result.end(), row->*part) == result.end()) {
      result.push_back(row->*part);
    }
  }
  return result;
}

std::vector<std::size_t> sizes(const Rows& rows) {
  std::set<std::size_t> result;
  for (const BenchmarkRow* row : rows) result.insert(row->triangles);
  return {result.begin(), result.end()};
}

std::vector<std::optional<double>> radii(const Rows& rows) {
  std::set<std::optional<double>> result;  // none is the least
  for (const BenchmarkRow* row : rows) result.insert(row->radius);
  return {result.rbegin(), result.rend()};
}

Rows at_radius(const Rows& rows, const std::optional<double>& radius) {
  return only(rows, [&](const BenchmarkRow& row) { return row.radius == radius; });
}

Rows on_mesh(const Rows& rows, const std::string& mesh) {
  return only(rows, [&](const BenchmarkRow& row) { return row.mesh == mesh; });
}

Rows on_common_mesh(const Rows& rows) {
  if (rows.empty()) return {};
  Rows largest_first = rows;
  std::stable_sort(
      largest_first.begin(), largest_first.end(),
      [](const BenchmarkRow* a, const BenchmarkRow* b) { return a->triangles > b->triangles; });
  using Size = std::pair<std::string, std::size_t>;
  const auto size = +[](const BenchmarkRow& row) { return Size(row.mesh, row.triangles); };
  const Size most = most_common(largest_first, size, [](const BenchmarkRow& row) {
    return std::tuple(row.index, row.activation, row.solver, row.radius);
  });
  return only(rows, [&](const BenchmarkRow& row) { return size(row) == most; });
}

Rows comparable_indices(const Rows& rows) {
  if (rows.empty()) return {};
  const auto place = [](const BenchmarkRow& row) {
    return std::tuple(row.mesh, row.triangles, row.radius, row.index);
  };
  const std::string rule = most_common(rows, &rule_of, place);
  Rows candidates = only(rows, [&](const BenchmarkRow& row) { return row.activation == rule; });
  const std::string solver = most_common(candidates, &solver_of, place);
  std::stable_partition(candidates.begin(), candidates.end(),
                        [&](const BenchmarkRow* row) { return row->solver == solver; });
  std::stable_partition(candidates.begin(), candidates.end(),
                        [](const BenchmarkRow* row) { return answers(*row); });
  std::set<decltype(place(*rows.front()))> taken;
  return only(candidates, [&](const BenchmarkRow& row) { return taken.insert(place(row)).second; });
}

Rows comparable_solvers(const Rows& rows) {
  if (rows.empty()) return {};
  const std::string rule = most_common(rows, &rule_of, solver_of);
  return only(rows, [&](const BenchmarkRow& row) { return row.activation == rule; });
}

Rows problems_of(const Rows& rows, const std::string& solver) {
  std::map<std::tuple<std::string, std::size_t, std::optional<double>>, Rows> problems;
  for (const BenchmarkRow* row : rows) {
    if (row->solver == solver) problems[{row->mesh, row->triangles, row->radius}].push_back(row);
  }
  Rows result;
  for (auto& [problem, same] : problems) {
    std::stable_sort(same.begin(), same.end(), [](const BenchmarkRow* a, const BenchmarkRow* b) {
      return faster(*a, *b, &BenchmarkRow::solve);
    });
    result.push_back(same[same.size() / 2]);
  }
  return result;
}

std::vector<Rows> rate_lines(const Rows& rows) {
  std::vector<Rows> lines;
  const auto add = [&](const BenchmarkRow& like) {
    Rows line = only(rows, [&](const BenchmarkRow& row) {
      return combination(row) == combination(like) && row.radius == like.radius;
    });
    std::stable_sort(line.begin(), line.end(), [](const BenchmarkRow* a, const BenchmarkRow* b) {
      return a->triangles < b->triangles;
    });
    lines.push_back(std::move(line));
  };
  for (const std::string& rule : names(rows, &BenchmarkRow::activation)) {
    const Rows under = only(rows, [&](const BenchmarkRow& row) { return row.activation == rule; });
    const auto those_of = [&](const Pair& pair) {
      return only(under, [&](const BenchmarkRow& row) { return is(row, pair); });
    };
    const Rows ours = those_of(our_pair), peers = those_of(peer_pair);
    if (ours.empty() && peers.empty()) {
      const Rows there = on_common_mesh(under);
      const Rows widest = at_radius(there, radii(there).front());
      add(fastest(widest, &BenchmarkRow::step));
      if (widest.size() > 1) add(slowest(widest, &BenchmarkRow::step));
    }
    for (const Rows& own : {ours, peers}) {
      if (!own.empty()) add(*at_radius(own, radii(own).front()).front());
    }
  }
  return lines;
}

double rate_khz(const BenchmarkRow& row) { return 1e3 / median(row, &BenchmarkRow::step); }

std::vector<RateCrossing> crossings_of_1_khz(const Rows& line) {
  std::vector<RateCrossing> crossings;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const BenchmarkRow& before = *line[i - 1];
    const BenchmarkRow& after = *line[i];
    const double from = std::log(rate_khz(before)), to = std::log(rate_khz(after));
    if ((from >= 0.0) == (to >= 0.0)) continue;
    const double share = from / (from - to);
    const auto small = static_cast<double>(before.triangles);
    const auto large = static_cast<double>(after.triangles);
    crossings.push_back({&before, &after, small * std::pow(large / small, share)});
  }
  return crossings;
}

std::string combination(const BenchmarkRow& row) {
  return row.index + ", " + row.activation + ", " + row.solver;
}

std::string radius_text(const std::optional<double>& radius) {
  return radius ? trimmed(*radius) + "\u00a0mm" : "as far as the motion leads";
}

std::string sphere_text(const std::optional<double>& radius) {
  return (radius ? "with a motion sphere of " : "looking ") + radius_text(radius);
}

std::string mesh_text(const BenchmarkRow& row) {
  return row.mesh + " with " + counted(row.triangles, "triangle");
}

bool is(const BenchmarkRow& row, const Pair& pair) {
  return row.index == pair.index && row.solver == pair.solver;
}

}  // namespace keepout::app
