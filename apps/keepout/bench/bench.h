// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "bench/combination.h"
#include "bench/speed/speed.h"
#include "bench/trial.h"
#include "stop_signal.h"

namespace CLI {
class App;
}

namespace keepout::app {

enum class Extent {
  standard,  // three sizes of the bunny; some minutes
  full       // to 18 million triangles, and the skull; tens of minutes
};

struct BenchOptions {
  bool list = false;                // what there is to measure, and no more
  bool is_speed = false;            // the table of ratios instead, to be measured as `speed` says
  SpeedOptions speed;               // but for what follows
  std::vector<std::string> meshes;  // fixtures or files; empty: up to the extent
  std::vector<std::size_t> triangles;  // sizes of the bunny; empty: up to the extent
  Selection selection;
  Extent extent = Extent::standard;
  std::optional<std::size_t> queries;
  std::optional<double> seconds;
  Poses poses = Poses::contact;
  std::uint64_t seed = 1;
  std::filesystem::path report = "keepout-bench.html";  // to be written
  std::optional<std::filesystem::path> json, csv;       // to be written
  std::string command;                                  // that does it again
};

/// Adds `keepout bench` and its options to the command line.
void add_bench(CLI::App& app, BenchOptions& options);

/// Measures every combination that was asked for on every mesh, prints a table as it goes, compares
/// the parts' answers on the first mesh, and writes a report and files. Throws Error before any
/// work when one could not be written, or there is no mesh of a name.
///
/// Gives the exit status: 0, or exit_interrupted when a signal stopped it. The rows that were
/// finished are then written all the same, marked as incomplete, and `notes` is told what was kept
/// and where; where there is none, nothing is written. The same goes for a mesh that turns out to
/// be broken: its error is thrown after the rows of those before it are written.
int bench(const BenchOptions& options, std::ostream& out, std::ostream& notes);

/// An empty record of this machine, for those rows on so many meshes.
Benchmark new_benchmark(const std::string& command, std::uint64_t seed,
                        const std::vector<Combination>& combinations, std::size_t meshes);

/// The combinations on one mesh, until it is stopped; `out` gets the table.
void run_trial(const Subject& subject, const std::vector<Combination>& combinations,
               const TrialSettings& settings, MemoryTaken& memory, const StopSignal& stop,
               Benchmark& benchmark, std::ostream& out);

}  // namespace keepout::app
