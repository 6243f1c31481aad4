// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.h"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <ostream>

#include "bench/benchmark.h"
#include "bench/parts.h"
#include "bench/used_cores.h"
#include "compare/compare.h"
#include "compare/comparison.h"
#include "keepout/activation/registry.h"
#include "keepout/error.h"
#include "keepout/fixtures/real_mesh.h"
#include "machine.h"
#include "named_mesh.h"
#include "names.h"
#include "number_text.h"
#include "output_file.h"
#include "progress.h"
#include "report/benchmark_report.h"
#include "report/text.h"

namespace keepout::app {
namespace {

/// From the paper's smallest bunny to its largest, and on.
std::vector<std::size_t> sizes_of(Extent extent) {
  if (extent == Extent::standard) return {51'978, 278'664, 989'376};
  return {51'978, 104'000, 278'664, 557'000, 989'376, 4'458'624, 17'834'496};
}

std::vector<Subject> chosen_subjects(const BenchOptions& options) {
  const bool is_default = options.meshes.empty();
  const bool own_sizes = !options.triangles.empty() || !is_default;
  std::vector<Subject> subjects =
      subjects_of(is_default ? std::vector{std::string(resampled_mesh)} : options.meshes,
                  own_sizes ? options.triangles : sizes_of(options.extent));
  if (options.extent == Extent::full && !own_sizes) subjects.push_back({"skull_1m", 0});
  // Tables and pictures know a mesh by its name.
  for (const Subject& one : subjects) {
    for (const Subject& other : subjects) {
      if (one.mesh == other.mesh || label_of(one) != label_of(other)) continue;
      throw Error("--mesh: '" + one.mesh + "' and '" + other.mesh +
                  "' could not be told apart in the report: give one of them another name");
    }
  }
  return subjects;
}

TrialSettings settings_of(const BenchOptions& options) {
  const bool full = options.extent == Extent::full;
  return {.queries = options.queries.value_or(full ? 5'000 : 2'500),
          .seconds = options.seconds.value_or(full ? 1.5 : 1.0),
          .poses = options.poses,
          .seed = options.seed};
}

/// Refuses a mesh of which there is none, too: a mistyped name is told of before the first row.
OutputFiles outputs_of(const BenchOptions& options, const std::vector<Subject>& subjects) {
  std::vector<NamedPath> inputs;
  for (const Subject& subject : subjects) {
    inputs.push_back({"--mesh", file_of_mesh(subject.mesh)});
  }
  return {inputs, {{"--json", options.json}, {"--csv", options.csv}, {"--out", options.report}}};
}

void list_absent(std::ostream& out, std::span<const AbsentPart> parts) {
  for (const AbsentPart& part : parts) {
    out << "  " << part.name << " is not in this build: needs " << part.needs << '\n';
  }
}

/// How well all parts agree; nothing, where the user wants to know about some only, or no more.
Comparison comparison_for(const BenchOptions& options, const Subject& subject,
                          const StopSignal& stop, std::ostream& out) {
  if (names_parts(options.selection)) return {};
  out << "\ncomparing answers on " << title_of(subject) << '\n';
  try {
    const Comparison comparison =
        compare_parts(label_of(subject), make_mesh(subject), {.seed = options.seed}, &stop);
    print(out, comparison);
    return comparison;
  } catch (const Error& error) {
    out << "left out: " << error.what() << '\n';
  } catch (const std::bad_alloc&) {
    out << "left out: not enough memory\n";
  }
  return {};
}

/// What there is to say beside its times; only some tables of parts have such.
template <class Entry>
std::string_view remark_of(const Entry& entry) {
  if constexpr (requires { entry.remark; }) return entry.remark;
  return {};
}

/// Says what there is to measure, and what this build was made without.
void list_parts(std::ostream& out) {
  out << listing("Indices (--index)", indices());
  list_absent(out, absent_indices());
  out << listing("Rules (--activation)", activation_rules());
  out << listing("Solvers (--solver)", solver_backends());
  list_absent(out, absent_solver_backends());
  out << "Meshes (--mesh; a file will do as well):\n ";
  for (const std::string_view mesh : real_meshes()) out << ' ' << mesh;
  out << "\n  --triangles resamples " << resampled_mesh << " to any number of triangles\n";
}

int measure_speed(const BenchOptions& options, std::ostream& out) {
  if (options.triangles.size() > 1) throw Error("--speed: give --triangles one size");
  SpeedOptions speed = options.speed;
  if (!options.triangles.empty()) speed.triangles = options.triangles.front();
  speed.seed = options.seed;
  speed.report = options.report;
  speed.json = options.json;
  speed.command = options.command;
  return bench_speed(speed, out);
}

}  // namespace

void run_trial(const Subject& subject, const std::vector<Combination>& combinations,
               const TrialSettings& settings, MemoryTaken& memory, const StopSignal& stop,
               Benchmark& benchmark, std::ostream& out) {
  Progress progress("bench " + title_of(subject), combinations.size());
  Trial trial(subject, settings, memory, stop);
  progress.interrupt();
  out << '\n'
      << label_of(subject) << ", " << counted(trial.mesh().triangle_count(), "triangle") << ", "
      << grouped(trial.mesh().vertex_count()) << " vertices; its file was read in "
      << rounded(trial.loaded().seconds, 2) << " s with " << rounded(trial.loaded().cores, 2)
      << " cores busy\n";
  print_table_head(out);
  for (const Combination& combination : combinations) {
    progress.show(combination.index + " " + combination.activation + " " + combination.solver);
    BenchmarkRow row = trial.measure(combination);
    progress.interrupt();
    if (stop.has_come()) return;
    benchmark.rows.push_back(std::move(row));
    print_table_row(out, benchmark.rows.back());
    out.flush();
    progress.advance();
  }
}

Benchmark new_benchmark(const std::string& command, std::uint64_t seed,
                        const std::vector<Combination>& combinations, std::size_t meshes) {
  Benchmark benchmark{.date = date_now(),
                      .command = command,
                      .seed = seed,
                      .machine = this_machine(),
                      .planned = combinations.size() * meshes};
  const auto describe = [&](const auto& table, std::string Combination::*part) {
    for (const auto& entry : table) {
      if (std::ranges::find(combinations, entry.name, part) != combinations.end()) {
        benchmark.parts.emplace(entry.name, entry.description);
        const std::string_view remark = remark_of(entry);
        if (!remark.empty()) benchmark.remarks.emplace(entry.name, remark);
      }
    }
  };
  describe(indices(), &Combination::index);
  describe(activation_rules(), &Combination::activation);
  describe(solver_backends(), &Combination::solver);
  return benchmark;
}

int bench(const BenchOptions& options, std::ostream& out, std::ostream& notes) {
  if (options.list) {
    list_parts(out);
    return EXIT_SUCCESS;
  }
  if (options.is_speed) return measure_speed(options, out);
  const std::vector<Subject> subjects = chosen_subjects(options);
  const std::vector<Combination> combinations = combinations_of(options.selection);
  if (combinations.empty()) throw Error("there is nothing to measure: see 'keepout bench --list'");
  OutputFiles outputs = outputs_of(options, subjects);

  const StopSignal stop;
  Benchmark benchmark = new_benchmark(options.command, options.seed, combinations, subjects.size());
  const UsedCores used;
  print_machine(out, benchmark.machine);
  out.flush();
  MemoryTaken memory;
  std::exception_ptr failure;  // of a mesh, after the rows of others
  for (const Subject& subject : subjects) {
    if (stop.has_come() || failure) break;
    try {
      run_trial(subject, combinations, settings_of(options), memory, stop, benchmark, out);
    } catch (const std::exception&) {
      if (benchmark.rows.empty()) throw;
      failure = std::current_exception();
    }
  }
  benchmark.others_cores = used.others();
  if (benchmark.rows.empty()) {
    notes << "keepout: stopped before any row was finished: nothing was written\n";
    return exit_interrupted;
  }
  // What has been measured is safe before anything else is tried.
  if (auto* const json = outputs.stream("--json")) write_json(*json, benchmark);
  if (auto* const csv = outputs.stream("--csv")) write_csv(*csv, benchmark);
  outputs.commit();
  const bool ended_early = failure || stop.has_come();
  print_benchmark_report(
      *outputs.stream("--out"), benchmark,
      ended_early ? Comparison{} : comparison_for(options, subjects.front(), stop, out));
  outputs.commit();
  print_verdict(out, benchmark);
  out << "report: " << options.report.string() << '\n';
  if (!failure && !stop.has_come()) return EXIT_SUCCESS;
  std::vector<std::string> kept{options.report.string()};
  for (const auto& path : {options.json, options.csv}) {
    if (path) kept.push_back(path->string());
  }
  notes << "keepout: stopped; " << grouped(benchmark.rows.size()) << " of "
        << counted(benchmark.planned, "row") << " were finished, and are kept in " << listed(kept)
        << '\n';
  if (failure) std::rethrow_exception(failure);
  return exit_interrupted;
}

}  // namespace keepout::app
