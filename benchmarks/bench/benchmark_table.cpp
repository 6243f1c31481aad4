// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <ostream>
#include <string>

#include "bench/benchmark.h"
#include "record/flat_rows.h"
#include "record/json_parts.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

/// Rates of the whole control step that Li et al. 2020 give in words for the Stanford bunny
/// (section on run time). They ran on an Intel Core i7-8700; the radius is not given.
struct PublishedRate {
  std::size_t triangles;
  std::size_t vertices;
  double khz;
};
constexpr std::array<PublishedRate, 2> published_rates = {
    {{51978, 25991, 7.73}, {989376, 493460, 0.180}}};

std::string time(const std::optional<double>& microseconds) {
  return microseconds ? rounded(*microseconds) : "-";
}

std::string median(const std::optional<Timing>& timing) { return timing ? time(timing->p50) : "-"; }

/// "  1.2 % worse"; nothing where there are none.
std::string share(double value, const char* of_what) {
  return value > 0.0 ? "  " + rounded(100.0 * value, 2) + " % " + of_what : "";
}

/// JSON has no 64-bit whole numbers that every reader keeps.
std::string hexadecimal(std::uint64_t value) {
  return formatted("%016llx", static_cast<unsigned long long>(value));
}

}  // namespace

void to_json(Json& json, const BenchmarkRow& row) {
  Json first_hashes = Json::object();
  for (std::size_t k = 0; k < row.first_hashes.size(); ++k) {
    first_hashes[std::to_string(std::size_t{1} << k)] = hexadecimal(row.first_hashes[k]);
  }
  json = {{"mesh", row.mesh},
          {"triangles", row.triangles},
          {"vertices", row.vertices},
          {"load_s", row.load_s},
          {"load_cores", row.load_cores},
          {"radius", row.radius},
          {"queries", row.queries},
          {"index", row.index},
          {"activation", row.activation},
          {"solver", row.solver},
          {"build_s", row.build_s},
          {"build_cores", row.build_cores},
          {"bytes_per_triangle", row.bytes_per_triangle},
          {"candidates_mean", row.candidates_mean},
          {"hits_mean", row.hits_mean},
          {"reaching_share", row.reaching_share},
          {"planes_mean", row.planes_mean},
          {"unsolved_share", row.unsolved_share},
          {"worse_share", row.worse_share},
          {"collect_us", row.collect},
          {"query_us", row.query},
          {"step_us", row.step},
          {"step_query_us", row.step_query},
          {"activate_us", row.activate},
          {"solve_us", row.solve},
          {"rate_khz", row.step && row.step->p50 > 0.0 ? Json(1e3 / row.step->p50) : Json()},
          {"hash", hexadecimal(row.hash)},
          {"hashes_of_first", std::move(first_hashes)},
          {"verified", row.verified},
          {"remark", row.remark}};
}

void print_machine(std::ostream& out, const Machine& machine) {
  out << machine.processor << ", " << counted(machine.cores, "core") << ", SIMD target "
      << machine.simd << '\n'
      << "build in s, and the cores that it kept busy; times in us, medians unless said\n"
         "collect, query: what the index proposes, and all triangles where the rule looks; for "
         "every index the same work, apart from the step\n"
         "find, activate, solve: stages of the step; '-' where the rule searches the tree by "
         "itself\n";
}

void print_headline(std::ostream& out, const Benchmark& benchmark) {
  for (const auto& [name, remark] : benchmark.remarks) {
    out << '\n' << name << ": " << remark;
  }
  out << '\n' << headline(benchmark) << '\n';
  if (benchmark.others_cores) {
    out << "cores that other processes kept busy: " << rounded(*benchmark.others_cores, 2) << " of "
        << benchmark.machine.cores << '\n';
  }
}

void print_table_head(std::ostream& out) {
  out << formatted(
      "%-6s %-18s %-9s %-12s %6s %5s %6s %7s %7s %7s | %8s %8s | %8s %8s %8s %8s %8s %8s\n", "r mm",
      "index", "rule", "solver", "build", "cores", "B/tri", "cand.", "hits", "planes", "collect",
      "query", "find", "activate", "solve", "step p50", "p99", "p99.9");
}

void print_table_row(std::ostream& out, const BenchmarkRow& row) {
  const std::string radius = row.radius ? trimmed(*row.radius) : "motion";
  out << formatted("%-6s %-18s %-9s %-12s ", radius.c_str(), row.index.c_str(),
                   row.activation.c_str(), row.solver.c_str());
  if (!row.step) {
    out << row.remark << '\n';
    return;
  }
  out << formatted("%6s %5s %6s %7s %7s %7s | %8s %8s | %8s %8s %8s %8s %8s %8s",
                   rounded(row.build_s, 2).c_str(), rounded(row.build_cores, 2).c_str(),
                   rounded(row.bytes_per_triangle).c_str(), rounded(row.candidates_mean, 2).c_str(),
                   rounded(row.hits_mean).c_str(), rounded(row.planes_mean).c_str(),
                   median(row.collect).c_str(), median(row.query).c_str(),
                   median(row.step_query).c_str(), median(row.activate).c_str(),
                   median(row.solve).c_str(), median(row.step).c_str(), time(row.step->p99).c_str(),
                   time(row.step->p999).c_str())
      << share(1.0 - row.reaching_share, "reach nothing")
      << share(row.unsolved_share, "without an answer") << share(row.worse_share, "worse") << '\n';
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
    // The same columns whatever was timed, so that files can be put together.
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

}  // namespace keepout::app
