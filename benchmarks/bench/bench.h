// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "bench/benchmark.h"
#include "record/record.h"
#include "simulate/simulate.h"

namespace CLI {
class App;
}

namespace keepout::app {

/// Of `bench --speed` alone.
struct SpeedOptions {
  std::optional<std::size_t> largest = {};  // triangles of a third mesh; none: left out
  std::size_t histogram_steps = 10'000'000;
  bool quick = false;  // few of everything
};

struct BenchOptions {
  bool list = false;      // what there is to measure, and no more
  bool is_speed = false;  // the table of ratios instead: see bench_speed()
  SpeedOptions speed;
  std::vector<std::string> meshes;     // fixtures or files; empty: the bunny
  std::vector<std::size_t> triangles;  // sizes of the bunny; empty: up to `full`
  Selection selection;
  bool full = false;  // to 18 million triangles, and the skull; tens of minutes
  std::optional<std::size_t> queries;
  std::optional<double> seconds;
  Poses poses = Poses::contact;
  std::uint64_t seed = 1;
  RecordFiles files = {.json = {}, .page = "keepout-bench.html"};
  std::string command;  // that does it again
};

/// Adds `keepout bench` and its options to the command line.
void add_bench(CLI::App& app, BenchOptions& options);

/// Measures every combination that was asked for on every mesh, prints a table as it goes, compares
/// the parts' answers on the first mesh, and writes a report and files. Throws Error before any
/// work when one could not be written, or there is no mesh of a name.
///
/// Gives the exit status: 0, or exit_interrupted when a signal stopped it. The rows that were
/// finished are then written all the same, marked as incomplete, and stderr tells what was kept and
/// where; where there is none, nothing is written. The same goes for a mesh that turns out to
/// be broken: its error is thrown after the rows of those before it are written.
int bench(const BenchOptions& options, std::ostream& out);

/// Measures the table of ratios that the engine is held to, prints it as it goes, and writes a
/// report and JSON, if asked for. What falls short is said, and is no error. A wish to stop ends it
/// after the family of rows at hand: what is measured is written, and said to be a part. The exit
/// status. Throws Error before any work when a file could not be written, or a fixture is missing.
int bench_speed(const BenchOptions& options, std::ostream& out);

/// Times all indices, rules and solvers on the mesh of a simulation, quickly, and compares their
/// answers. A signal stops it, and it keeps what is finished.
PartTimings time_parts(const SimulateOptions& options, const std::shared_ptr<const Mesh>& mesh,
                       std::ostream& out);

}  // namespace keepout::app
