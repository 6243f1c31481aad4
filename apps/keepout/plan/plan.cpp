// SPDX-License-Identifier: BSD-3-Clause
#include "plan/plan.h"

#include <cstdlib>
#include <memory>
#include <ostream>
#include <utility>

#include "keepout/activation/certified.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/ompl/straight_way.h"
#include "named_mesh.h"
#include "number_text.h"
#include "output_file.h"
#include "plan/planning_result.h"
#include "progress.h"
#include "stop_signal.h"

namespace keepout::app {
namespace {

PlanningScene load(const std::filesystem::path& path, std::string name, PlanningScene::Space space,
                   PlanningScene::Starts starts) {
  return planning_scene(
      std::make_unique<Scene>(std::move(name), load_named_mesh(path).mesh, "wide_bvh"), space,
      starts);
}

std::vector<PlanningScene> scenes_of(const PlanOptions& options) {
  using Space = PlanningScene::Space;
  using Starts = PlanningScene::Starts;
  std::vector<PlanningScene> scenes;
  if (options.mesh) {
    scenes.push_back(load(*options.mesh, options.mesh->filename().string(),
                          options.inside ? Space::within : Space::around, Starts::anywhere));
  } else {
    // From the throat up into nose and sinuses.
    scenes.push_back(load("airway", "airway", Space::within, Starts::below));
    scenes.push_back(load("skull", "skull", Space::around, Starts::anywhere));
  }
  return scenes;
}

/// Sides are not asked about: a certified motion never changes them, whichever way the mesh is
/// wound, so a tree that starts within stays within.
constexpr Inside sides = Inside::taken_as_is;

using SharedIndex = std::shared_ptr<const SpatialIndex>;

std::shared_ptr<GuardPool> steering_guards(const PlanOptions& options, const PlanningScene& where,
                                           const SharedIndex& index) {
  return std::make_shared<GuardPool>([&options, index, mesh = where.scene->mesh()] {
    return make_motion_constraint(mesh, index,
                                  {.radius = options.radius,
                                   .tool_radius = options.tool_radius,
                                   .margin = options.margin,
                                   .inside = sides});
  });
}

/// The same, but for a solver that does not search where a motion is held back.
std::shared_ptr<GuardPool> validating_guards(const PlanOptions& options, const PlanningScene& where,
                                             const SharedIndex& index) {
  return std::make_shared<GuardPool>([&options, index, mesh = where.scene->mesh()] {
    return MotionConstraint(
        mesh, index, std::make_unique<CertifiedRule>(mesh), std::make_unique<StraightOnly>(),
        {.radius = options.radius, .margin = options.tool_radius + options.margin}, {}, sides);
  });
}

OutputFiles outputs_of(const PlanOptions& options) {
  std::vector<NamedPath> inputs;
  if (options.mesh) inputs.push_back({"MESH", file_of_mesh(*options.mesh)});
  return {inputs, {{"--json", options.json}, {"--csv", options.csv}, {"--out", options.page}}};
}

void run_scene(const PlanOptions& options, PlanningScene& where, Progress& progress,
               const StopSignal& stop, std::vector<PlanningRun>& runs) {
  const double clearance = options.tool_radius + options.margin;
  progress.show(where.scene->name() + ", drawing problems");
  const std::vector<Problem> problems =
      draw_problems(where, clearance, options.problems, options.seed);
  const SharedIndex index = make_index("wide_bvh", where.scene->mesh());
  const std::shared_ptr<GuardPool> validating = validating_guards(options, where, index);
  const std::shared_ptr<GuardPool> steering = steering_guards(options, where, index);
  const double least = least_distance(*where.scene, clearance, options.radius);
  for (const Problem& problem : problems) {
    for (const Checker& checker : checkers(options.resolutions)) {
      if (stop.has_come()) return;
      progress.show(where.scene->name() + " " + std::to_string(problem.number) + ", " +
                    checker.name());
      const bool slides = checker.kind == Checker::Kind::sliding;
      PlanningRun run{.mesh = where.scene->name(),
                      .planner = slides ? "SlidingConnect" : options.planner,
                      .checker = checker,
                      .problem = problem,
                      .path = run_planner({.where = &where,
                                           .problem = &problem,
                                           .checker = checker,
                                           .planner = options.planner,
                                           .seed = options.seed + problem.number,
                                           .seconds = options.seconds,
                                           .range = options.range,
                                           .simplify = options.simplify,
                                           .clearance = clearance,
                                           .guards = slides ? steering : validating},
                                          [&stop] { return stop.has_come(); }),
                      .verdict = {}};
      // Cut short it tells nothing.
      if (stop.has_come() && !run.path.solved) return;
      if (run.path.solved) run.verdict = judge_path(*where.scene, run.path.points, least);
      runs.push_back(std::move(run));
      progress.advance();
    }
  }
}

/// What keepout let pass and the oracle does not.
std::size_t invalid_of_keepout(const std::vector<PlanningRun>& runs) {
  std::size_t count = 0;
  for (const PlanningRun& run : runs) {
    count += run.checker.is_keepouts() && run.path.solved && !run.verdict.is_valid();
  }
  return count;
}

void print_lead(std::ostream& out, const PlanOptions& options) {
  out << options.planner << ", " << trimmed(options.seconds) << " s for each problem, clearance "
      << trimmed(options.tool_radius + options.margin) << " mm, seed " << options.seed;
  if (options.simplify) out << ", simplified";
  out << ". The sliding checker has a planner of its own, SlidingConnect.\n"
      << "valid: of those solved, by the exact oracle over the whole of each path.\n\n";
}

}  // namespace

int plan(const PlanOptions& options, std::ostream& out) {
  OutputFiles outputs = outputs_of(options);
  const StopSignal stop;  // after the files, which a second signal removes
  std::vector<PlanningScene> scenes = scenes_of(options);
  std::vector<PlanningRun> runs;
  const std::size_t total = scenes.size() * options.problems * checkers(options.resolutions).size();
  {
    Progress progress("plan", total);
    for (PlanningScene& where : scenes) {
      if (!stop.has_come()) run_scene(options, where, progress, stop, runs);
    }
  }
  if (auto* const json = outputs.stream("--json")) write_planning_json(*json, options, runs);
  if (auto* const csv = outputs.stream("--csv")) write_planning_csv(*csv, runs);
  if (auto* const page = outputs.stream("--out")) write_planning_page(*page, options, scenes, runs);
  outputs.commit();
  print_lead(out, options);
  print_table(out, summaries(runs));
  if (stop.has_come()) {
    out << "\ninterrupted: " << runs.size() << " of " << total << " runs are finished\n";
  }
  const std::size_t invalid = invalid_of_keepout(runs);
  if (invalid > 0) out << "\n" << counted(invalid, "path") << " of keepout's are not valid!\n";
  if (invalid > 0) return EXIT_FAILURE;
  return stop.has_come() ? exit_interrupted : EXIT_SUCCESS;
}

}  // namespace keepout::app
