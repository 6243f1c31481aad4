// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <limits>
#include <map>
#include <ostream>
#include <string>
#include <tuple>
#include <utility>

#include "bench/bench.h"
#include "record/flat_rows.h"
#include "record/json_parts.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

using Rows = std::vector<const BenchmarkRow*>;  // in their order

/// Returns all conditions of a row but its index and solver. The largest mesh with the largest
/// sphere sorts last.
auto conditions(const BenchmarkRow& row) {
  return std::tie(row["triangles"], row["radius"], row["activation"], row["mesh"]);
}

double median(const BenchmarkRow* row) { return (*row)["step_us"]["p50"]; }

/// Returns the hash over all steps of a row, or over the first of them, a power of two.
Json hash_over(const BenchmarkRow& row, std::size_t steps) {
  return row["queries"] == steps ? row["hash"] : row["hashes_of_first"].at(std::to_string(steps));
}

std::size_t queries_of(const BenchmarkRow* row) { return (*row)["queries"]; }

/// Rates of the whole control step that Li et al. 2020 give in words for the Stanford bunny
/// (section on run time). They ran on an Intel Core i7-8700; the radius is not given.
struct PublishedRate {
  std::size_t triangles;
  std::size_t vertices;
  double khz;
};
constexpr std::array<PublishedRate, 2> published_rates = {
    {{51978, 25991, 7.73}, {989376, 493460, 0.180}}};

/// Returns text such as "  1.2 % worse"; empty for 0.
std::string share(double value, const char* of_what) {
  return value > 0.0 ? "  " + rounded(100.0 * value, 2) + " % " + of_what : "";
}

std::string median_text(const Json& us) { return us.is_null() ? "-" : figure_text(us["p50"]); }

using Row = BenchmarkRow;

Column<Row> column(const char* key, const char* heading, int width,
                   std::string (*text)(const Json&) = &plain) {
  return {key, [key](const Row& row) { return row[key]; }, heading, width, text};
}

/// Returns a column for a percentile of the step.
Column<Row> of_step(const char* percentile, const char* heading) {
  return {"", [percentile](const Row& row) { return row["step_us"][percentile]; }, heading, 8,
          figure_text};
}

const Column<Row> bar{"", [](const Row&) { return Json("|"); }, "|", 1};

/// The conditions of a row, and its figures; the table shows figures only for timed rows.
const Columns<Row> name_columns{
    column("radius", "r mm", -6,
           [](const Json& mm) { return mm.is_null() ? "motion" : trimmed(mm.get<double>()); }),
    column("index", "index", -18), column("activation", "rule", -9),
    column("solver", "solver", -12)};
const Columns<Row> figure_columns{column("build_s", "build", 6, figure_text<2>),
                                  column("build_cores", "cores", 5, figure_text<2>),
                                  column("bytes_per_triangle", "B/tri", 6, figure_text),
                                  column("candidates_mean", "cand.", 7, figure_text<2>),
                                  column("hits_mean", "hits", 7, figure_text),
                                  column("planes_mean", "planes", 7, figure_text),
                                  bar,
                                  column("collect_us", "collect", 8, median_text),
                                  column("query_us", "query", 8, median_text),
                                  bar,
                                  column("step_query_us", "find", 8, median_text),
                                  column("activate_us", "activate", 8, median_text),
                                  column("solve_us", "solve", 8, median_text),
                                  of_step("p50", "step p50"),
                                  of_step("p99", "p99"),
                                  of_step("p999", "p99.9")};

}  // namespace

BenchmarkRow new_row() {
  return Json::parse(R"({
    "mesh": "", "triangles": 0, "vertices": 0, "load_s": 0.0, "load_cores": 0.0,
    "radius": null, "queries": 0, "index": "", "activation": "", "solver": "",
    "build_s": 0.0, "build_cores": 0.0, "bytes_per_triangle": 0.0,
    "candidates_mean": 0.0, "hits_mean": 0.0, "reaching_share": 0.0,
    "planes_mean": 0.0, "unsolved_share": 0.0, "worse_share": 0.0,
    "collect_us": null, "exact_us": null, "query_us": null, "step_us": null, "step_medians_us": [],
    "step_query_us": null, "activate_us": null, "solve_us": null, "rate_khz": null,
    "hash": "0000000000000000", "hashes_of_first": {}, "verified": false, "wrong": false, "remark": ""})");
}

constexpr std::size_t fewest_ranked = 20;  // steps of a row, for its median to be ranked

Ranking ranking_of(const Benchmark& benchmark) {
  Rows rows;
  for (const BenchmarkRow& row : benchmark.rows) {
    const bool has_few_steps = row["queries"] < fewest_ranked;
    if (!row["step_us"].is_null() && median(&row) > 0.0 && row["remark"] == "" && !has_few_steps) {
      rows.push_back(&row);
    }
  }
  if (rows.empty()) return {};
  const auto largest = std::ranges::max(
      rows, [](const auto* a, const auto* b) { return conditions(*a) < conditions(*b); });
  std::erase_if(rows, [&](const auto* row) { return conditions(*row) != conditions(*largest); });
  Rows both;
  std::ranges::copy_if(rows, std::back_inserter(both), [](const auto* row) {
    return std::ranges::any_of(pairs, [&](const Pair& pair) {
      return (*row)["index"] == pair.index && (*row)["solver"] == pair.solver;
    });
  });
  const auto [fastest, slowest] =
      std::ranges::minmax(both.size() == pairs.size() ? both : rows, {}, median);
  return {fastest, slowest};
}

Json step_groups_of(const Benchmark& benchmark) {
  using Problem = decltype(std::pair(conditions(benchmark.rows[0]), Json()));
  std::map<Problem, Rows> groups;
  std::size_t not_verified = 0, single = 0, members = 0, compared = 0, same = 0;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (row["verified"] && row["queries"] > 0) {
      groups[{conditions(row), row["solver"]}].push_back(&row);
    } else {
      ++not_verified;
    }
  }
  std::size_t fewest = std::numeric_limits<std::size_t>::max(), most = 0;
  for (const auto& [problem, rows] : groups) {
    if (rows.size() < 2) {
      ++single;
      continue;
    }
    const BenchmarkRow& longest = **std::ranges::max_element(rows, {}, queries_of);
    bool all = true;
    for (const BenchmarkRow* row : rows) {
      if (row == &longest) continue;
      const std::size_t queries = queries_of(row);
      const std::size_t steps = longest["queries"] == queries ? queries : std::bit_floor(queries);
      fewest = std::min(fewest, steps);
      most = std::max(most, steps);
      all = all && hash_over(*row, steps) == hash_over(longest, steps);
    }
    members += rows.size();
    ++compared;
    same += all ? 1 : 0;
  }
  return {{"groups", compared},
          {"rows", members},
          {"same", same},
          {"fewest_steps", compared > 0 ? Json(fewest) : Json()},
          {"most_steps", compared > 0 ? Json(most) : Json()},
          {"single", single},
          {"not_verified", not_verified}};
}

std::size_t wrong_rows(const Benchmark& benchmark) {
  return static_cast<std::size_t>(std::ranges::count_if(
      benchmark.rows, [](const BenchmarkRow& row) { return row["wrong"].get<bool>(); }));
}

std::string headline(const Benchmark& benchmark) {
  const auto [fastest, slowest] = ranking_of(benchmark);
  const std::size_t wrong = wrong_rows(benchmark);
  const std::string fault = wrong == 0 ? ""
                                       : " The answers of " + grouped(wrong) + " of " +
                                             counted(benchmark.rows.size(), "row") + " are wrong.";
  if (fastest == nullptr) return "No combination was timed that can be ranked." + fault;
  const auto time = [](const BenchmarkRow* row) {
    return time_text(median(row)) + " with " + plain((*row)["index"]) + " and " +
           plain((*row)["solver"]);
  };
  return "Under rule '" + plain((*fastest)["activation"]) + "' on " + plain((*fastest)["mesh"]) +
         " (" + counted((*fastest)["triangles"], "triangle") + "), a step takes " + time(fastest) +
         (fastest == slowest
              ? "."
              : ", " + time(slowest) + ": " + rounded(median(slowest) / median(fastest), 2) +
                    " times as long.") +
         fault;
}

void print_machine(std::ostream& out, const Machine& machine) {
  out << machine.processor << ", " << counted(machine.cores, "core") << ", SIMD target "
      << machine.simd << '\n'
      << "build in s, and the cores that it kept busy; times in us, medians unless stated\n"
         "collect, query: candidates of the index, and all triangles in the rule's region; the "
         "same work for every index, apart from the step\n"
         "find, activate, solve: stages of the step; '-' if the rule searches the tree "
         "itself\n";
}

void print_headline(std::ostream& out, const Benchmark& benchmark) {
  for (const auto& [name, remark] : benchmark.remarks) {
    out << '\n' << name << ": " << remark;
  }
  out << '\n' << for_terminal(headline(benchmark)) << '\n';
  if (benchmark.others_cores) {
    out << "cores that other processes kept busy: " << rounded(*benchmark.others_cores, 2) << " of "
        << benchmark.machine.cores << '\n';
  }
}

void print_table_head(std::ostream& out) {
  print_headings(out, name_columns);
  out << ' ';
  print_headings(out, figure_columns);
  out << '\n';
}

void print_table_row(std::ostream& out, const BenchmarkRow& row) {
  print_row(out, name_columns, row);
  out << ' ';
  if (row["step_us"].is_null()) {
    out << plain(row["remark"]) << '\n';
    return;
  }
  print_row(out, figure_columns, row);
  out << share(1.0 - row["reaching_share"].get<double>(), "reach nothing")
      << share(row["unsolved_share"], "without an answer") << share(row["worse_share"], "worse")
      << '\n';
}

Json json_of(const Benchmark& benchmark) {
  const auto [fastest, slowest] = ranking_of(benchmark);
  const auto number = [&](const BenchmarkRow* row) {
    return row == nullptr ? Json() : Json(row - benchmark.rows.data());
  };
  Json published = Json::array(), compared = Json::array();
  for (const auto& [triangles, vertices, khz] : published_rates) {
    published.push_back({{"triangles", triangles}, {"vertices", vertices}, {"khz", khz}});
  }
  for (const auto& [index, solver] : pairs) {
    compared.push_back({{"index", index}, {"solver", solver}});
  }
  return {{"headline", headline(benchmark)},
          {"complete", benchmark.rows.size() >= benchmark.planned},
          {"seed", benchmark.seed},
          {"machine", benchmark.machine},
          {"planned_rows", benchmark.planned},
          {"others_cores", benchmark.others_cores},
          {"parts", benchmark.parts},
          {"remarks", benchmark.remarks},
          {"published", std::move(published)},
          {"pairs", std::move(compared)},
          {"fastest", number(fastest)},
          {"slowest", number(slowest)},
          {"step_groups", step_groups_of(benchmark)},
          {"rows", benchmark.rows}};
}

void write_csv(std::ostream& out, const Benchmark& benchmark) {
  Json rows = benchmark.rows;
  for (Json& row : rows) {
    row.erase("hashes_of_first");
    // Always the same columns, so that files can be combined.
    for (auto& [key, value] : row.items()) {
      if (!key.ends_with("_us") || !value.is_null()) continue;
      value = {{"p50", nullptr}, {"p99", nullptr}, {"p999", nullptr}, {"max", nullptr}};
    }
    row.update({{"date", benchmark.date},
                {"processor", benchmark.machine.processor},
                {"simd", benchmark.machine.simd},
                {"keepout", benchmark.machine.keepout},
                {"others_cores", benchmark.others_cores}});
  }
  print_csv(out, flat(rows));
}

void write_short_csv(std::ostream& out, const Benchmark& benchmark) {
  Json rows = Json::array();
  for (const BenchmarkRow& row : benchmark.rows) {
    Json& kept = rows.emplace_back();
    for (const char* key :
         {"mesh", "triangles", "index", "activation", "solver", "radius", "build_s",
          "bytes_per_triangle", "queries", "candidates_mean", "hits_mean"}) {
      kept[key] = row[key];
    }
    for (const char* stage : {"collect_us", "exact_us", "query_us", "step_us"}) {
      for (const char* percentile : {"p50", "p99"}) {
        kept[stage][percentile] = row[stage].is_null() ? Json() : row[stage][percentile];
      }
    }
    kept["verified"] = row["verified"];
  }
  print_csv(out, flat(rows));
}

}  // namespace keepout::app
