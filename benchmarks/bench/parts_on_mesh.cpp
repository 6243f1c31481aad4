// SPDX-License-Identifier: BSD-3-Clause
#include "bench/parts_on_mesh.h"

#include <iostream>

#include "bench/bench.h"
#include "bench/benchmark.h"
#include "compare/compare.h"
#include "compare/comparison.h"
#include "shared/number_text.h"

namespace keepout::app {

PartTimings time_parts(const SimulateOptions& options, const std::shared_ptr<const Mesh>& mesh,
                       std::ostream& out) {
  const StopSignal stop;
  Benchmark benchmark;
  run_benchmark({.command = options.command,
                 .subjects = {{.mesh = options.meshes.front().string()}},
                 .combinations = combinations_of({.radii = {5.0, 1.0}}),
                 .queries = 1500,
                 .seconds = 0.3},
                stop, benchmark, out);
  Comparison comparison;
  const std::size_t rows = benchmark.rows.size();
  if (!stop.has_come()) {
    comparison = compare_parts(options.meshes.front().stem().string(), mesh,
                               {.poses = 12, .problems = 400, .pairs = 100},
                               [&stop] { return stop.has_come(); });
    print(out, comparison);
  } else if (rows == 0) {
    std::cerr << "keepout: stopped before any row of the benchmark was finished: the report is of "
                 "the simulation alone\n";
  } else {
    std::cerr << "keepout: stopped; " << grouped(rows) << " of "
              << counted(benchmark.planned, "row")
              << " of the benchmark were finished, and are kept in the report\n";
  }
  return {.benchmark = rows == 0 ? Json() : json_of(benchmark),
          .comparison = json_of(comparison),
          .combinations = rows,
          .complete = rows >= benchmark.planned && comparison.complete};
}

}  // namespace keepout::app
