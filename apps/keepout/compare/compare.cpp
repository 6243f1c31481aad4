// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "compare/compare.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ostream>

#include "bench/parts.h"
#include "bench/subject.h"
#include "compare/comparison_files.h"
#include "compare/index_agreement.h"
#include "compare/narrow_phase_agreement.h"
#include "compare/solver_agreement.h"
#include "keepout/activation/registry.h"
#include "output_file.h"
#include "part_lists.h"
#include "progress.h"

namespace keepout::app {
namespace {

/// All but brute force, which they are held to.
std::vector<std::string> indices_to_compare() {
  std::vector<std::string> all = names(indices());
  std::erase(all, "brute_force");
  return all;
}

/// No index may differ in any bit, no solver be wrong; the narrow phases are not ours.
bool agree(const Comparison& comparison) {
  return std::ranges::all_of(comparison.indices,
                             [](const IndexAgreement& a) {
                               return a.missed == 0 && a.invented == 0 && a.plane_angle == 0.0 &&
                                      a.steps_that_differ == 0;
                             }) &&
         std::ranges::all_of(comparison.solvers,
                             [](const SolverAgreement& a) { return a.wrong == 0; });
}

}  // namespace

Comparison compare_parts(const std::string& mesh_name, const std::shared_ptr<const Mesh>& mesh,
                         const CompareExtent& extent) {
  Comparison comparison;
  const std::vector<std::string> rules = names(activation_rules());
  {
    const std::vector<std::string> compared = indices_to_compare();
    Progress progress("compare indices", extent.poses * rules.size() * (compared.size() + 1));
    comparison.indices = compare_indices({.mesh_name = mesh_name,
                                          .mesh = mesh,
                                          .indices = compared,
                                          .activations = rules,
                                          .poses = extent.poses,
                                          .seed = extent.seed},
                                         [&] { progress.advance(); });
  }
  comparison.solvers = compare_solvers(mesh, {.rules = rules,
                                              .solvers = names(solver_backends()),
                                              .problems = extent.problems / rules.size(),
                                              .seed = extent.seed,
                                              .most = {{"nlopt_cobyla", extent.problems / 10},
                                                       {"nlopt_mma", extent.problems / 10}}});
  Progress progress("compare narrow phases", narrow_phase_rows());
  comparison.narrow_phases = compare_narrow_phases(*mesh, extent.pairs, extent.seed, progress);
  return comparison;
}

int compare(const CompareOptions& options, std::ostream& out) {
  std::unique_ptr<OutputFile> json;
  if (options.json) {
    refuse_shared_files(std::array{NamedPath{"MESH", options.mesh}},
                        std::array{NamedPath{"--json", *options.json}});
    json = std::make_unique<OutputFile>(*options.json);
  }
  const Subject subject{.mesh = options.mesh};
  const Comparison comparison =
      compare_parts(label_of(subject), make_mesh(subject), options.extent);
  print(out, comparison);
  if (json) {
    write_json(json->stream(), comparison);
    json->commit();
  }
  if (agree(comparison)) return EXIT_SUCCESS;
  out << "\nParts that must not differ do: please report it.\n";
  return EXIT_FAILURE;
}

}  // namespace keepout::app
