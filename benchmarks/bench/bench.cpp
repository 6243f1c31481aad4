// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <ostream>

#include "compare/compare.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/solvers/registry.h"
#include "record/record.h"
#include "shared/command_line.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/output_file.h"

namespace keepout::app {
namespace {

/// Returns each mesh once, and the bunny once for each size.
std::vector<Subject> chosen_subjects(const BenchOptions& options) {
  const bool is_default = options.meshes.empty() && options.triangles.empty();
  std::vector<std::string> meshes = options.meshes;
  if (meshes.empty()) meshes.emplace_back(resampled_mesh);
  std::vector<std::size_t> sizes = options.triangles;
  // From the smallest to the largest bunny of Li et al. (2020), and larger.
  if (is_default) sizes = {51'978, 278'664, 989'376};
  if (is_default && options.full) {
    sizes = {51'978, 104'000, 278'664, 557'000, 989'376, 4'458'624, 17'834'496};
  }
  if (!sizes.empty() && std::ranges::find(meshes, resampled_mesh) == meshes.end()) {
    throw Error("--triangles applies to the resampled mesh only: add " +
                std::string(resampled_mesh) + " to --mesh, or omit --triangles");
  }
  std::vector<Subject> subjects;
  for (const std::string& mesh : meshes) {
    if (std::ranges::find(subjects, mesh, &Subject::mesh) != subjects.end()) continue;
    // Tables and plots identify a mesh by its name.
    const auto other = std::ranges::find(subjects, label_of({mesh}), label_of);
    if (other != subjects.end()) {
      throw Error("--mesh: '" + other->mesh + "' and '" + mesh +
                  "' would have the same name in the report: rename one of them");
    }
    if (mesh == resampled_mesh) {
      for (const std::size_t size : sizes) subjects.push_back({mesh, size});
    }
    if (mesh != resampled_mesh || sizes.empty()) subjects.push_back({mesh});
  }
  if (is_default && options.full) subjects.push_back({"skull_1m"});
  for (Subject& subject : subjects) subject.load = options.load;
  return subjects;
}

/// Returns the options with the defaults of --sweep: all indices but brute force, on sizes of the
/// bunny in half decades. Without --sweep, returns them as they are.
BenchOptions with_sweep(BenchOptions options) {
  if (!options.sweep) return options;
  auto& [indices, activations, solvers, radii] = options.selection;
  if (indices.empty()) {
    indices = index_names();
    std::erase(indices, "brute_force");
  }
  if (radii.empty()) radii = {5.0, 1.0};
  if (options.meshes.empty() && options.triangles.empty()) {
    options.triangles = {10'000, 31'623, 100'000, 316'228, 1'000'000};
    if (options.full) options.triangles.insert(options.triangles.end(), {3'162'278, 10'000'000});
  }
  return options;
}

Json record_of(const Benchmark& benchmark, const Comparison& comparison) {
  Json record =
      new_record({.kind = "bench",
                  .date = benchmark.date,
                  .command = benchmark.command,
                  .complete = benchmark.rows.size() >= benchmark.planned && comparison.complete,
                  .subject = "Search trees, activation rules and solvers, on the same motions",
                  .headline = headline(benchmark),
                  .machine = benchmark.machine,
                  .settings = {{"seed", std::to_string(benchmark.seed)}}});
  record["benchmark"] = json_of(benchmark);
  record["comparison"] = json_of(comparison);
  return record;
}

/// Compares the parts. Returns an empty comparison if the user selected parts, or after a stop.
Comparison comparison_for(const BenchOptions& options, const Subject& subject,
                          const StopSignal& stop, std::ostream& out) {
  if (names_parts(options.selection)) return {};
  out << "\ncomparing answers on " << title_of(subject) << '\n';
  try {
    const Comparison comparison =
        compare_parts(label_of(subject), make_mesh(subject), {.seed = options.seed},
                      [&stop] { return stop.has_come(); });
    print(out, comparison);
    return comparison;
  } catch (const Error& error) {
    out << "left out: " << error.what() << '\n';
  } catch (const std::bad_alloc&) {
    out << "left out: not enough memory\n";
  }
  return {};
}

/// Lists the parts that can be measured, and those that this build lacks.
void list_parts(std::ostream& out) {
  const auto list_absent = [&](std::span<const PeerPart> parts) {
    for (const PeerPart& part : parts) {
      out << "  " << part.name << " is not in this build: needs " << part.needs << '\n';
    }
  };
  out << listing("Indices (--index)", index_backends());
  list_absent(index_backends().absent());
  out << listing("Rules (--activation)", activation_rules());
  out << listing("Solvers (--solver)", solver_backends());
  list_absent(solver_backends().absent());
  out << "Meshes (--mesh; or a file):\n ";
  for (const std::string_view mesh : real_meshes()) out << ' ' << mesh;
  out << "\n  --triangles resamples " << resampled_mesh << " to any number of triangles\n";
}

/// Must be called after the other options exist, because --speed excludes most of them.
void add_speed_options(CLI::App& command, BenchOptions& options) {
  SpeedOptions& speed_options = options.speed;
  CLI::Option* speed = command.add_flag(
      "--speed", options.is_speed,
      "Measure the table of required ratios, in one process on one core; takes some "
      "minutes. With --triangles: one size, for meshes of about a million");
  for (const char* name :
       {"--list", "--sweep", "--plugin", "--index", "--activation", "--solver", "--mesh",
        "--radius", "--full", "--queries", "--seconds", "--poses", "--csv"}) {
    speed->excludes(name);
  }
  command
      .add_option("--steps", speed_options.histogram_steps,
                  "With --speed: number of steps in the histogram")
      ->type_name("NUMBER")
      ->transform(whole_number(1, most_steps))
      ->needs(speed)
      ->capture_default_str();
  command
      .add_option(
          "--largest", speed_options.largest,
          "With --speed: also measure a mesh of this many triangles. 100000000 need 14 GiB of "
          "memory, 5 GB of disk, and some minutes")
      ->type_name("NUMBER")
      ->transform(whole_number(1000, 200'000'000))
      ->needs(speed);
  command
      .add_flag("--quick", speed_options.quick, "With --speed: a short run, to test that it works")
      ->needs(speed);
}

}  // namespace

void add_bench(CLI::App& app, BenchOptions& options) {
  CLI::App& command = *app.add_subcommand("bench",
                                          "Time every stage of the step, for indices, rules and "
                                          "solvers side by side; compare each with "
                                          "brute force and with keepout's own solver");
  command.add_flag("--list", options.list, "List what can be measured, and exit");
  const auto add_list = [&](const char* name, std::vector<std::string>& list,
                            const CLI::Validator& known, const char* text) {
    command.add_option(name, list, text)->delimiter(',')->type_name("NAMES")->check(known);
  };
  add_plugins(command);
  add_list("--index", options.selection.indices, one_of_parts(index_names(), index_backends),
           "Indices to measure");
  add_list("--activation", options.selection.activations, one_of(names(activation_rules())),
           "Rules to measure");
  add_list("--solver", options.selection.solvers, one_of_parts(solver_names(), solver_backends),
           "Solvers to measure");
  CLI::Option* const mesh =
      command.add_option("--mesh", options.meshes, "Sample meshes, or mesh files")
          ->delimiter(',')
          ->type_name("NAMES");
  add_load_options(command, options.load);
  for (const char* name : {"--space", "--untagged", "--unit", "--scale", "--flip"}) {
    command.get_option(name)->needs(mesh);
  }
  command
      .add_option("--triangles", options.triangles,
                  "Sizes to which to resample the bunny, 150 mm large as in Li et al. (2020)")
      ->delimiter(',')
      ->type_name("NUMBERS")
      ->transform(whole_number(1000, 200'000'000));
  command
      .add_option(
          "--radius", options.selection.radii,
          "Radii of the motion sphere, in mm; certified searches as far as the motion goes, "
          "whatever the radius")
      ->delimiter(',')
      ->type_name("MM")
      ->check(length(Zero::refused));
  command.add_flag(
      "--sweep", options.sweep,
      "Each index against the number of triangles: 10000 to a million, with --full 10 million; "
      "--csv then writes a short table. --triangles or --mesh: other sizes");
  command.add_flag(
      "--full", options.full,
      "Up to 18 million triangles, and the skull with a million; takes tens of minutes and 14 GB");
  command.add_option("--queries", options.queries, "Most steps of each combination; default: 2500")
      ->type_name("NUMBER")
      ->transform(whole_number(5, 10'000'000));
  command
      .add_option("--seconds", options.seconds,
                  "Most time for a combination in each of two rounds: stage by stage, "
                  "and whole steps; default: 1")
      ->type_name("S")
      ->check(length(Zero::refused));
  command
      .add_option(
          "--poses", options.poses,
          "contact: a tool that slides along the surface; unrelated: all over, as for a planner")
      ->transform(one_of<Poses>({{"contact", Poses::contact}, {"unrelated", Poses::unrelated}}))
      ->default_str("contact");
  add_number(command, "--seed", options.seed, 0, largest_seed, "Seed of the motions");
  options.files.add_to(command);
  command.add_option("--csv", options.files.csv, "Where to write the rows as a table")
      ->type_name("FILE");
  add_speed_options(command, options);
  command.footer(
      "The lists are combined with each other. Defaults: wide_bvh; paper and certified;\n"
      "active_set; radii of 5, 1 and 0.25. Without --index, --activation and --solver: each "
      "index,\n"
      "then each solver, with these defaults; and FCL's tree with SLSQP.");
}

bool is_right(const Benchmark& benchmark, const Comparison& comparison) {
  return wrong_rows(benchmark) == 0 && agree(comparison);
}

int bench(const BenchOptions& given, std::ostream& out) {
  const BenchOptions options = with_sweep(given);
  if (options.list) {
    list_parts(out);
    return EXIT_SUCCESS;
  }
  if (options.is_speed) return bench_speed(options, out);
  const BenchmarkPlan plan{.command = options.command,
                           .subjects = chosen_subjects(options),
                           .combinations = combinations_of(options.selection),
                           .queries = options.queries.value_or(options.full ? 5'000 : 2'500),
                           .seconds = options.seconds.value_or(options.full ? 1.5 : 1.0),
                           .poses = options.poses,
                           .seed = options.seed};
  if (plan.combinations.empty()) {
    throw Error("there is nothing to measure: see 'keepout bench --list'");
  }
  const RecordFiles& files = options.files;
  std::vector<std::string> meshes;
  for (const Subject& subject : plan.subjects) meshes.push_back(subject.mesh);
  // Also rejects a mesh that does not exist, before the first row.
  std::optional outputs(files.open(meshes, "--mesh"));

  const StopSignal stop(keeps_what_is_finished);
  Benchmark benchmark;
  std::exception_ptr failure;  // of a mesh, after rows of other meshes
  try {
    run_benchmark(plan, stop, benchmark, out);
  } catch (const std::exception&) {
    if (benchmark.rows.empty()) throw;
    failure = std::current_exception();
  }
  if (benchmark.rows.empty()) {
    std::cerr << "keepout: stopped before any row was finished: nothing was written\n";
    return exit_interrupted;
  }
  // Files are written before the answers are compared, so that no row is lost, and again at the
  // end. An open file, such as stdout, cannot be replaced: it is written at the end only.
  Json record = record_of(benchmark, {});
  record["complete"] = false;  // until the answers are compared as well
  const auto write_table = [&] {
    if (auto* const csv = outputs->stream("--csv")) {
      options.sweep ? write_short_csv(*csv, benchmark) : write_csv(*csv, benchmark);
    }
  };
  const bool is_replaced = std::ranges::none_of(
      std::array{files.json, files.csv, files.page},
      [](const auto& file) { return file && entry_of_open_file(*file).has_value(); });
  if (is_replaced) {
    write_table();
    if (auto* const json = outputs->stream("--json")) print_json(*json, record);
    outputs->commit();
  }
  Comparison comparison;
  if (!failure && !stop.has_come()) {
    comparison = comparison_for(options, plan.subjects.front(), stop, out);
    record = record_of(benchmark, comparison);
  }
  if (is_replaced) {
    outputs.reset();
    outputs.emplace(files.open(meshes, "--mesh"));
  }
  write_table();  // again, so that a failure to write names all files
  write_record(*outputs, record, files);
  print_headline(out, benchmark);
  out << "report: " << files.page->string() << '\n';
  const std::size_t wrong = wrong_rows(benchmark);
  if (wrong > 0) {
    std::cerr << "keepout: the answers of " << grouped(wrong) << " of "
              << counted(benchmark.rows.size(), "row") << " are wrong: see what the rows say\n";
  }
  if (!failure && !stop.has_come()) {
    return is_right(benchmark, comparison) ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  std::cerr << "keepout: stopped; " << grouped(benchmark.rows.size()) << " of "
            << counted(benchmark.planned, "row") << " were finished, and are kept in "
            << files.names() << '\n';
  if (failure) std::rethrow_exception(failure);
  return exit_interrupted;
}

PartTimings time_parts(const SimulateOptions& options, const std::shared_ptr<const Mesh>& mesh,
                       const StopSignal& stop, std::ostream& out) {
  Benchmark benchmark;
  run_benchmark({.command = options.command,
                 .subjects = {{.mesh = options.meshes.front().string(), .load = options.load}},
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
          .complete = rows >= benchmark.planned && comparison.complete,
          .is_wrong = !is_right(benchmark, comparison)};
}

}  // namespace keepout::app
