// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdio>
#include <ostream>

#include "bench/benchmark_files.h"
#include "bench/json_parts.h"
#include "report/benchmark_verdict.h"

namespace keepout::app {
namespace {

Json json_of(const std::optional<Timing>& timing) {
  return timing ? app::json_of(*timing) : Json(nullptr);
}

/// JSON has no 64-bit whole numbers that every reader keeps.
std::string hexadecimal(std::uint64_t value) {
  std::array<char, 20> text;
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

Json json_of(const BenchmarkRow& row) {
  Json first_hashes = Json::object();
  for (std::size_t k = 0; k < row.first_hashes.size(); ++k) {
    first_hashes[std::to_string(std::size_t{1} << k)] = hexadecimal(row.first_hashes[k]);
  }
  return {{"mesh", row.mesh},
          {"triangles", row.triangles},
          {"vertices", row.vertices},
          {"load_s", row.load_s},
          {"load_cores", row.load_cores},
          {"radius", or_null(row.radius)},
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
          {"collect_us", json_of(row.collect)},
          {"query_us", json_of(row.query)},
          {"step_us", json_of(row.step)},
          {"step_query_us", json_of(row.step_query)},
          {"activate_us", json_of(row.activate)},
          {"solve_us", json_of(row.solve)},
          {"hash", hexadecimal(row.hash)},
          {"hashes_of_first", std::move(first_hashes)},
          {"verified", row.verified},
          {"remark", row.remark}};
}

}  // namespace

void write_json(std::ostream& out, const Benchmark& benchmark) {
  Json rows = Json::array();
  for (const BenchmarkRow& row : benchmark.rows) rows.push_back(json_of(row));
  const Json all = {{"date", benchmark.date},
                    {"command", benchmark.command},
                    {"seed", benchmark.seed},
                    {"machine", json_of(benchmark.machine)},
                    {"others_cores", or_null(benchmark.others_cores)},
                    {"complete", benchmark.rows.size() >= benchmark.planned},
                    {"planned_rows", benchmark.planned},
                    {"headline", headline(benchmark)},
                    {"account", account(benchmark)},
                    {"parts", benchmark.parts},
                    {"remarks", benchmark.remarks},
                    {"rows", std::move(rows)}};
  out << all.dump(2) << '\n';
}

}  // namespace keepout::app
