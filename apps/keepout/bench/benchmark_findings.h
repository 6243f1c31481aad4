// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "bench/benchmark_rows.h"

namespace keepout::app {

/// What to see in some rows of a benchmark, in words made of their figures. Only ranked() rows are
/// set against each other.
struct BenchmarkFinding {
  enum class About { queries, rates, solvers, stages, costs, steps };
  About about;
  std::string mesh = {};  // empty: all
  std::string text = {};
  Rows rows = {};  // in the order in which a picture shows them
};

/// Of all that was timed, mesh by mesh: the index's query and the stages of a step for each sphere,
/// the largest first; the rate of each combination that is worth a line; the solvers; what an index
/// costs; and whether rows that must make the same steps did. The benchmark must outlive them.
std::vector<BenchmarkFinding> findings(const Benchmark& benchmark);

}  // namespace keepout::app
