// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "bench/benchmark.h"
#include "compare/comparison.h"
#include "simulation_record.h"

namespace keepout::app {

/// Writes the report as one HTML page that needs nothing but itself. Throws Error when there is no
/// mesh, no run, or a stroke without a cycle, or when runs differ in their strokes.
void print_report(std::ostream& out, const Simulation& simulation);

/// The same, and after it how fast the parts are and how well they agree: see benchmark_report.h.
void print_report(std::ostream& out, const Simulation& simulation, const Benchmark& benchmark,
                  const Comparison& comparison);

}  // namespace keepout::app
