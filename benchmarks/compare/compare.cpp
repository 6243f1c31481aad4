// SPDX-License-Identifier: BSD-3-Clause
#include "compare/compare.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "compare/subject.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/solvers/registry.h"
#include "shared/command_line.h"
#include "shared/machine.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/output_file.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

/// Returns an error with two digits, or "0" if it is exactly 0.
std::string small(const Json& value) {
  return value == 0.0 ? "0" : formatted("%.1e", value.get<double>());
}

template <class Row>
Json p50(const Row& row) {
  return row.us.p50;
}
/// Returns the longest time if there are too few for a percentile.
template <class Row>
Json p99(const Row& row) {
  return row.us.p99.value_or(row.us.max);
}

using Index = IndexAgreement;
const Columns<Index> index_columns = {
    {"mesh", &Index::mesh, "mesh", -10, [](const Json& v) { return plain(v).substr(0, 10); }},
    {"index", &Index::index, "index", -17},
    {"activation", &Index::activation, "rule", -10},
    {"searched_by_the_rule", &Index::searched, "form", -8,
     [](const Json& v) { return std::string(v.get<bool>() ? "searches" : "plain"); }},
    {"poses", &Index::poses, "poses", 6},
    {"missed", &Index::missed, "missed", 7},
    {"invented", &Index::invented, "invented", 9},
    {"closest_point_error_mm", &Index::closest_point_error, "closest p. mm", 13, small},
    {"plane_angle_rad", &Index::plane_angle, "plane rad", 10, small},
    {"step_difference_mm", &Index::step_difference, "step mm", 10, small},
    {"steps_that_differ", &Index::steps_that_differ, "differ", 9}};

using Solved = SolverAgreement;
const Columns<Solved> solver_columns = {
    {"solver", &Solved::solver, "solver", -13},
    {"activation", &Solved::activation, "rule", -10},
    {"posed", &Solved::posed},
    {"problems", &Solved::problems, "problems", 9},
    {"optimal", &Solved::optimal, "optimal", 9},
    {"infeasible", &Solved::infeasible, "infeasible", 11},
    {"gave_up", &Solved::gave_up, "gave up", 8},
    {"wrong", &Solved::wrong, "wrong", 6},
    {"step_difference", &Solved::step_difference, "step", 10, small},
    {"kkt_residual", &Solved::kkt_residual, "KKT", 10, small},
    {"p50_us", p50<Solved>, "p50 us", 9, figure_text},
    {"p99_us", p99<Solved>, "p99 us", 9, figure_text},
    {"outcomes", &Solved::outcomes}};

using Phase = NarrowPhaseAgreement;
const Columns<Phase> narrow_phase_columns = {
    {"backend", &Phase::backend, "narrow phase", -16},
    {"tool", &Phase::tool, "tool", -9},
    {"relation", &Phase::relation, "relation", -12},
    {"pairs", &Phase::pairs, "pairs", 7},
    {"failed", &Phase::failed, "failed", 7},
    {"contradicted", &Phase::contradicted, "contradicted", 13},
    {"median_error_mm", &Phase::median_error, "median mm", 12, small},
    {"worst_error_mm", &Phase::worst_error, "worst mm", 12, small},
    {"worst_unproven_mm", &Phase::worst_unproven, "unproven mm", 12, small},
    {"p50_us", p50<Phase>, "p50 us", 9, figure_text},
    {"p99_us", p99<Phase>, "p99 us", 9, figure_text}};

void print_outcomes(std::ostream& out, const std::vector<SolverAgreement>& solvers) {
  out << "  What the library said -> what we found:\n";
  for (const SolverAgreement& a : solvers) {
    for (const auto& [outcome, count] : a.outcomes) {
      out << formatted("  %-13s %-10s %9zu  %s\n", a.solver.c_str(), a.activation.c_str(), count,
                       outcome.c_str());
    }
  }
}

std::size_t sum(const auto& rows, auto count) {
  std::size_t result = 0;
  for (const auto& row : rows) result += row.*count;
  return result;
}

/// Returns all indices but brute force, which is the reference.
std::vector<std::string> indices_to_compare() {
  std::vector<std::string> all = index_names();
  std::erase(all, "brute_force");
  return all;
}

}  // namespace

bool agree(const Comparison& comparison) {
  return std::ranges::all_of(comparison.indices,
                             [](const Index& row) {
                               return row.missed == 0 && row.invented == 0 &&
                                      row.plane_angle == 0.0 && row.steps_that_differ == 0;
                             }) &&
         sum(comparison.solvers, &Solved::wrong) == 0;
}

std::string headline(const Comparison& comparison) {
  const auto& [is_complete, indices, solvers, narrow_phases] = comparison;
  const std::string extent = is_complete ? "" : "Interrupted. ";
  if (indices.empty()) return extent + "Nothing was compared.";
  if (agree(comparison)) {
    return extent + "All indices made brute force's steps in " +
           counted(sum(indices, &Index::poses), "comparison") + ", and no solver was wrong on " +
           counted(sum(solvers, &Solved::problems), "problem") + ".";
  }
  const double angle = std::ranges::max(indices, {}, &Index::plane_angle).plane_angle;
  return extent + "Parts disagree, please report it: " +
         counted(sum(indices, &Index::missed), "missed triangle") + ", " +
         counted(sum(indices, &Index::invented), "invented triangle") + ", " +
         counted(sum(indices, &Index::steps_that_differ), "different step") + ", planes up to " +
         small(angle) + " rad apart, " + counted(sum(solvers, &Solved::wrong), "wrong answer") +
         ".";
}

void print(std::ostream& out, const Comparison& comparison) {
  if (!comparison.indices.empty()) {
    out << "\nIndices in motion constraints, compared with brute force (closest points: with exact "
           "arithmetic)\n";
    print_rows(out, index_columns, comparison.indices);
  }
  if (!comparison.solvers.empty()) {
    out << "\nSolvers on recorded problems, compared with active_set and the KKT conditions\n";
    print_rows(out, solver_columns, comparison.solvers);
    print_outcomes(out, comparison.solvers);
  }
  if (!comparison.narrow_phases.empty()) {
    out << "\nNarrow phases, compared with the exact kernel; touching: within " << touch_text
        << ", on either side\n";
    print_rows(out, narrow_phase_columns, comparison.narrow_phases);
  }
  out << '\n' << headline(comparison) << '\n';
}

Json json_of(const Comparison& comparison) {
  const auto part = [](const auto& columns, const auto& rows) {
    return rows.empty() ? Json() : Json{{"rows", json_of(columns, rows)}};
  };
  const auto& [complete, indices, solvers, narrow_phases] = comparison;
  if (indices.empty() && solvers.empty() && narrow_phases.empty()) return nullptr;
  return {{"complete", complete},
          {"agree", agree(comparison)},
          {"indices", part(index_columns, indices)},
          {"solvers", part(solver_columns, solvers)},
          {"narrow_phases", part(narrow_phase_columns, narrow_phases)}};
}

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
  CLI::App& command = *app.add_subcommand("compare",
                                          "Compare all parts that can replace each other with each "
                                          "other and with a reference, on the same "
                                          "input: indices, solvers, narrow phases");
  command.add_option("MESH", options.mesh, std::string(mesh_help))->capture_default_str();
  add_load_options(command, options.load);
  add_plugins(command);
  add_number(command, "--poses", options.extent.poses, 6, 1'000'000,
             "Poses for the indices, under each rule");
  add_number(command, "--problems", options.extent.problems, 10, 1'000'000,
             "Recorded problems for the solvers, the same number from each rule");
  add_number(
      command, "--pairs", options.extent.pairs, 10, 1'000'000,
      "Pairs of tool and triangle for the narrow phases, of each relation: apart, overlapping, "
      "and touching (within " +
          std::string(touch_text) + " of contact)");
  add_number(command, "--seed", options.extent.seed, 0, largest_seed,
             "Seed of poses, problems and pairs");
  options.files.add_to(command);
  command.footer(
      "The exit status is 0 only if all indices are bitwise identical and no solver is wrong; 130 "
      "after\n"
      "Ctrl-C, which keeps the finished rows.");
}

int compare(const CompareOptions& options, std::ostream& out) {
  OutputFiles outputs = options.files.open({options.mesh});
  const Subject subject{.mesh = options.mesh, .load = options.load};
  // While the mesh is read and the poses are drawn, there are no results to keep yet.
  const StopSignal stop(keeps_what_is_finished, BeforeWork::ends_process);
  const std::shared_ptr<const Mesh> mesh = make_mesh(subject);
  const Comparison comparison = naming(subject, [&] {
    return compare_parts(label_of(subject), mesh, options.extent, [&stop] {
      stop.keep_from_now_on();
      return stop.has_come();
    });
  });
  if (!comparison.complete && comparison.indices.empty()) {
    std::cerr << "keepout: stopped before anything was finished: nothing was written\n";
    return exit_interrupted;
  }
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
  write_record(outputs, record, options.files);
  if (!comparison.complete) return exit_interrupted;
  return agree(comparison) ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace keepout::app
