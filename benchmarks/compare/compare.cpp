// SPDX-License-Identifier: BSD-3-Clause
#include "compare/compare.h"

#include <cstdlib>
#include <iostream>

#include "compare/agreement.h"
#include "compare/comparison.h"
#include "compare/subject.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/solvers/registry.h"
#include "record/record.h"
#include "shared/command_line.h"
#include "shared/machine.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/output_file.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

/// All but brute force, which they are held to.
std::vector<std::string> indices_to_compare() {
  std::vector<std::string> all = index_names();
  std::erase(all, "brute_force");
  return all;
}

}  // namespace

Comparison compare_parts(const std::string& mesh_name, const std::shared_ptr<const Mesh>& mesh,
                         const CompareExtent& extent, const Stopped& stopped) {
  const std::vector<std::string> rules = names(activation_rules());
  Comparison comparison;
  comparison.indices = compare_indices({.mesh_name = mesh_name,
                                        .mesh = mesh,
                                        .indices = indices_to_compare(),
                                        .activations = rules,
                                        .poses = extent.poses,
                                        .seed = extent.seed},
                                       stopped);
  if (!stopped()) {
    comparison.solvers = compare_solvers(
        mesh,
        {.rules = rules,
         .solvers = solver_names(),
         .problems = extent.problems / rules.size(),
         .seed = extent.seed,
         .most = {{"nlopt_cobyla", extent.problems / 10}, {"nlopt_mma", extent.problems / 10}}},
        stopped);
  }
  if (!stopped()) {
    comparison.narrow_phases = compare_narrow_phases(*mesh, extent.pairs, extent.seed, stopped);
  }
  comparison.complete = !stopped();
  return comparison;
}

void add_compare(CLI::App& app, CompareOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "compare",
      "Hold all parts that can take each other's place to each other and to the truth, on the same "
      "input: indices, solvers, narrow phases");
  command.add_option("MESH", options.mesh, std::string(mesh_help))->capture_default_str();
  add_number(command, "--poses", options.extent.poses, 6, 1'000'000,
             "Poses for the indices, under each rule");
  add_number(command, "--problems", options.extent.problems, 10, 1'000'000,
             "Recorded problems for the solvers");
  add_number(command, "--pairs", options.extent.pairs, 10, 1'000'000,
             "Pairs of tool and triangle for the narrow phases, of each kind: apart, overlapping, "
             "and touching, which is within " +
                 std::string(touch_text) + " of a touch, on either side");
  add_number(command, "--seed", options.extent.seed, 0, largest_seed,
             "Seed of poses, problems and pairs");
  options.files.add_to(command);
  command.footer(
      "The exit status is 0 only if all indices agree to the bit and no solver is wrong; 130 "
      "after\n"
      "Ctrl-C, which keeps the rows that are finished.");
}

int compare(const CompareOptions& options, std::ostream& out) {
  OutputFiles outputs = options.files.open({options.mesh});
  const Subject subject{.mesh = options.mesh};
  const std::shared_ptr<const Mesh> mesh = make_mesh(subject);
  const StopSignal stop;
  const Comparison comparison =
      compare_parts(label_of(subject), mesh, options.extent, [&stop] { return stop.has_come(); });
  print(out, comparison);
  const CompareExtent& extent = options.extent;
  Json record = new_record(
      {.kind = "compare",
       .command = options.command,
       .complete = comparison.complete,
       .subject =
           "Parts that can take each other's place, held to each other and to the truth, on " +
           label_of(subject) + " (" + counted(mesh->triangle_count(), "triangle") + ")",
       .headline = headline(comparison),
       .machine = this_machine(),
       .settings = {{"poses under each rule", std::to_string(extent.poses)},
                    {"problems", std::to_string(extent.problems)},
                    {"pairs of each kind", std::to_string(extent.pairs)},
                    {"seed", std::to_string(extent.seed)}}});
  record["mesh"] = label_of(subject);
  record["triangles"] = mesh->triangle_count();
  record["seed"] = extent.seed;
  record["asked_for"] = {
      {"poses", extent.poses}, {"problems", extent.problems}, {"pairs", extent.pairs}};
  record["comparison"] = json_of(comparison);
  write_record(outputs, record, options.files, std::cerr);
  if (!comparison.complete) return exit_interrupted;
  return agree(comparison) ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace keepout::app
