// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <charconv>
#include <ostream>
#include <string>

#include "bench/benchmark_files.h"

namespace keepout::app {
namespace {

/// The fewest digits that read back exactly.
std::string number(double value) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string number(const std::optional<double>& value) { return value ? number(*value) : ""; }

/// A name of a file may hold anything.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

constexpr std::array stages = {&BenchmarkRow::collect,  &BenchmarkRow::query,
                               &BenchmarkRow::step,     &BenchmarkRow::step_query,
                               &BenchmarkRow::activate, &BenchmarkRow::solve};
constexpr std::array stage_names = {"collect", "query", "step", "step_query", "activate", "solve"};

}  // namespace

void write_csv(std::ostream& out, const Benchmark& benchmark) {
  out << "mesh,triangles,vertices,radius,queries,index,activation,solver,load_s,load_cores,build_s,"
         "build_cores,bytes_per_triangle,candidates_mean,hits_mean,reaching_share,planes_mean,"
         "unsolved_share,worse_share";
  for (const char* stage : stage_names) {
    for (const char* which : {"p50", "p99", "p999", "max"}) out << ',' << stage << "_us_" << which;
  }
  out << ",hash,verified,remark,date,processor,simd,keepout,others_cores\n";
  for (const BenchmarkRow& row : benchmark.rows) {
    out << quoted(row.mesh) << ',' << row.triangles << ',' << row.vertices << ','
        << number(row.radius) << ',' << row.queries << ',' << row.index << ',' << row.activation
        << ',' << row.solver;
    for (const double value :
         {row.load_s, row.load_cores, row.build_s, row.build_cores, row.bytes_per_triangle,
          row.candidates_mean, row.hits_mean, row.reaching_share, row.planes_mean,
          row.unsolved_share, row.worse_share}) {
      out << ',' << number(value);
    }
    for (const auto stage : stages) {
      const std::optional<Timing>& timing = row.*stage;
      if (!timing) {
        out << ",,,,";
        continue;
      }
      out << ',' << number(timing->p50) << ',' << number(timing->p99) << ',' << number(timing->p999)
          << ',' << number(timing->max);
    }
    out << ',' << std::hex << row.hash << std::dec << ',' << (row.verified ? "true" : "false")
        << ',' << quoted(row.remark) << ',' << benchmark.date << ','
        << quoted(benchmark.machine.processor) << ',' << benchmark.machine.simd << ','
        << benchmark.machine.keepout << ',' << number(benchmark.others_cores) << '\n';
  }
}

}  // namespace keepout::app
