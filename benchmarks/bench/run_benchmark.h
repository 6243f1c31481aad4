// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "bench/benchmark.h"
#include "bench/combination.h"
#include "compare/subject.h"
#include "shared/stop_signal.h"

namespace keepout::app {

enum class Poses {
  contact,   // a tool that presses on the surface and slides along it, cycle after cycle
  unrelated  // all over the surface, as a planner asks
};

/// What to measure, and how thoroughly.
struct BenchmarkPlan {
  std::string command;  // that does it again
  std::vector<Subject> subjects;
  std::vector<Combination> combinations;  // those of one index together: it is built once
  std::size_t queries = 2500;             // of each combination, at most
  double seconds = 1.0;                   // after which one is asked no more: see measure()
  Poses poses = Poses::contact;
  std::uint64_t seed = 1;  // of the motions, which are the same for all combinations on a mesh
};

/// Measures every combination on every mesh until it is stopped, and prints the machine and a table
/// as it goes. What cannot be built, or gives a wrong answer, is not timed, and the row's remark
/// says why. The benchmark gets the rows that are finished, also where this throws Error: for a
/// mesh that is broken.
void run_benchmark(const BenchmarkPlan& plan, const StopSignal& stop, Benchmark& benchmark,
                   std::ostream& out);

}  // namespace keepout::app
