// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.h"

#include <memory>
#include <new>
#include <ostream>

#include "bench/benchmark_files.h"
#include "bench/benchmark_table.h"
#include "bench/machine_record.h"
#include "bench/parts.h"
#include "compare/compare.h"
#include "compare/comparison_files.h"
#include "keepout/activation/registry.h"
#include "keepout/error.h"
#include "keepout/fixtures/real_mesh.h"
#include "machine.h"
#include "number_text.h"
#include "output_file.h"
#include "part_lists.h"
#include "progress.h"
#include "report/benchmark_report.h"

namespace keepout::app {
namespace {

/// From the paper's smallest bunny to its largest, and on.
std::vector<std::size_t> sizes_of(Extent extent) {
  if (extent == Extent::standard) return {51'978, 278'664, 989'376};
  return {51'978, 104'000, 278'664, 557'000, 989'376, 4'458'624, 17'834'496};
}

std::vector<Subject> chosen_subjects(const BenchOptions& options) {
  if (options.extent == Extent::full && options.meshes.empty() && options.triangles.empty()) {
    std::vector<Subject> subjects = subjects_of(
        std::vector<std::string>{std::string(resampled_mesh)}, sizes_of(options.extent));
    subjects.push_back({"skull_1m", 0});
    return subjects;
  }
  const bool is_default = options.meshes.empty();
  const std::vector<std::string> meshes =
      is_default ? std::vector<std::string>{std::string(resampled_mesh)} : options.meshes;
  const bool own_sizes = !options.triangles.empty() || !is_default;
  return subjects_of(meshes, own_sizes ? options.triangles : sizes_of(options.extent));
}

TrialSettings settings_of(const BenchOptions& options) {
  const bool full = options.extent == Extent::full;
  return {.queries = options.queries.value_or(full ? 5'000 : 2'500),
          .seconds = options.seconds.value_or(full ? 1.5 : 1.0),
          .poses = options.poses,
          .seed = options.seed};
}

std::unique_ptr<OutputFile> open(const std::optional<std::filesystem::path>& path) {
  return path ? std::make_unique<OutputFile>(*path) : nullptr;
}

void refuse_overwriting(const BenchOptions& options) {
  std::vector<NamedPath> inputs, outputs;
  for (const std::string& mesh : options.meshes) inputs.push_back({"--mesh", mesh});
  if (options.json) outputs.push_back({"--json", *options.json});
  if (options.csv) outputs.push_back({"--csv", *options.csv});
  outputs.push_back({"--out", options.report});
  refuse_shared_files(inputs, outputs);
}

void list_absent(std::ostream& out, std::span<const AbsentPart> parts) {
  for (const AbsentPart& part : parts) {
    out << "  " << part.name << " is not in this build: needs " << part.needs << '\n';
  }
}

/// How well all parts agree; nothing, where the user wants to know about some only.
Comparison comparison_for(const BenchOptions& options, const Subject& subject, std::ostream& out) {
  if (names_parts(options.selection)) return {};
  out << "\ncomparing answers on " << title_of(subject) << '\n';
  try {
    const Comparison comparison =
        compare_parts(label_of(subject), make_mesh(subject), {.seed = options.seed});
    print(out, comparison);
    return comparison;
  } catch (const Error& error) {
    out << "left out: " << error.what() << '\n';
  } catch (const std::bad_alloc&) {
    out << "left out: not enough memory\n";
  }
  return {};
}

}  // namespace

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

void run_trial(const Subject& subject, const std::vector<Combination>& combinations,
               const TrialSettings& settings, MemoryTaken& memory, Benchmark& benchmark,
               std::ostream& out) {
  Progress progress("bench " + title_of(subject), combinations.size());
  Trial trial(subject, settings, memory);
  progress.interrupt();
  out << '\n'
      << label_of(subject) << ", " << counted(trial.mesh().triangle_count(), "triangle") << ", "
      << grouped(trial.mesh().vertex_count()) << " vertices (build in s; times in us, medians "
      << "unless said)\n";
  print_table_head(out);
  for (const Combination& combination : combinations) {
    progress.show(combination.index + " " + combination.activation + " " + combination.solver);
    const BenchmarkRow& row = benchmark.rows.emplace_back(trial.measure(combination));
    progress.interrupt();
    print_table_row(out, row);
    out.flush();
    progress.advance();
  }
}

void bench(const BenchOptions& options, std::ostream& out) {
  const std::vector<Subject> subjects = chosen_subjects(options);
  const std::vector<Combination> combinations = combinations_of(options.selection);
  if (combinations.empty()) throw Error("there is nothing to measure: see 'keepout bench --list'");
  refuse_overwriting(options);
  OutputFile report(options.report);
  const std::unique_ptr<OutputFile> json = open(options.json), csv = open(options.csv);

  Benchmark benchmark{.date = date_now(),
                      .command = options.command,
                      .seed = options.seed,
                      .machine = this_machine()};
  MemoryTaken memory;
  for (const Subject& subject : subjects) {
    run_trial(subject, combinations, settings_of(options), memory, benchmark, out);
  }
  // What has been measured is safe before anything else is tried.
  if (json) write_json(json->stream(), benchmark);
  if (csv) write_csv(csv->stream(), benchmark);
  for (OutputFile* file : {json.get(), csv.get()}) {
    if (file != nullptr) file->finish();
  }
  for (OutputFile* file : {json.get(), csv.get()}) {
    if (file != nullptr) file->commit();
  }
  print_benchmark_report(report.stream(), benchmark,
                         comparison_for(options, subjects.front(), out));
  report.commit();
  out << "report: " << options.report.string() << '\n';
}

}  // namespace keepout::app
