// SPDX-License-Identifier: BSD-3-Clause
#include "plan/plan.h"

#include <cstdlib>
#include <iostream>
#include <memory>
#include <ostream>
#include <utility>

#include "keepout/activation/certified.h"
#include "keepout/error.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/ompl/straight_way.h"
#include "plan/planning_run.h"
#include "plan/robot/plan_robot.h"
#include "record/flat_rows.h"
#include "shared/named_mesh.h"
#include "shared/output_file.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"
#include "shared/wrapped_text.h"

namespace keepout::app {
namespace {

std::vector<PlanningScene> scenes_of(const PlanOptions& options) {
  using Space = PlanningScene::Space;
  std::vector<PlanningScene> scenes;
  if (options.mesh) {
    scenes.push_back(
        load_planning_scene(*options.mesh, options.inside ? Space::within : Space::around));
  } else {
    // From the throat up into nose and sinuses.
    scenes.push_back(load_planning_scene("airway", Space::within, PlanningScene::Starts::below));
    scenes.push_back(load_planning_scene("skull", Space::around));
  }
  return scenes;
}

/// Sides are not asked about: a certified motion never changes them, whichever way the mesh is
/// wound, so a tree that starts within stays within.
constexpr Inside sides = Inside::taken_as_is;

std::shared_ptr<GuardPool> steering_guards(const PlanOptions& options, const Scene& scene) {
  return std::make_shared<GuardPool>([&options, &scene] {
    return make_motion_constraint(scene.mesh(), scene.shared_index(),
                                  {.options = {.radius = options.radius,
                                               .tool_radius = options.tool_radius,
                                               .margin = options.margin},
                                   .inside = sides});
  });
}

/// The same, but for a solver that does not search where a motion is held back.
std::shared_ptr<GuardPool> validating_guards(const PlanOptions& options, const Scene& scene) {
  return std::make_shared<GuardPool>([&options, &scene] {
    return MotionConstraint(scene.mesh(), scene.shared_index(), std::make_unique<CertifiedRule>(),
                            std::make_unique<StraightOnly>(),
                            {.radius = options.radius, .margin = options.clearance()}, {}, sides);
  });
}

OutputFiles outputs_of(const PlanOptions& options) {
  std::vector<NamedPath> inputs;
  if (options.mesh) inputs.push_back({"MESH", file_of_mesh(*options.mesh)});
  return {inputs,
          {{"--json", options.files.kept_json()},
           {"--csv", options.csv},
           {"--out", options.files.page}}};
}

void run_planning_scene(const PlanOptions& options, PlanningScene& where, Progress& progress,
                        const StopSignal& stop, std::vector<PlanningRun>& runs) {
  const Scene& scene = where.scene;
  progress.show(scene.name() + ", drawing problems");
  const std::vector<Problem> problems =
      draw_problems(where, options.clearance(), options.problems, options.seed);
  const std::shared_ptr<GuardPool> validating = validating_guards(options, scene);
  const std::shared_ptr<GuardPool> steering = steering_guards(options, scene);
  const double least = least_distance(scene, options);
  for (const Problem& problem : problems) {
    for (const Checker& checker : checkers(options.resolutions)) {
      if (stop.has_come()) return;
      progress.show(scene.name() + " " + std::to_string(problem.number) + ", " + checker.name());
      const PlanningTask task{options, where, problem, checker,
                              checker.slides() ? steering : validating};
      PlannedPath path = run_planner(task, [&stop] { return stop.has_come(); });
      // Cut short it tells nothing.
      if (stop.has_come() && !path.solved) return;
      const PathVerdict verdict =
          path.solved ? judge_path(scene, path.points, least) : PathVerdict{};
      std::vector<std::vector<Vec3>> too_near;
      if (!verdict.is_valid()) too_near = lengths_too_near(scene, path.points, least);
      runs.push_back({scene.name(), task.planner(), checker, problem, std::move(path), verdict,
                      std::move(too_near)});
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

}  // namespace

int plan(const PlanOptions& options, std::ostream& out) {
  if (!options.robot.empty()) return plan_with_robot(options, out);
  OutputFiles outputs = outputs_of(options);
  const StopSignal stop;  // after the files, which a second signal removes
  std::vector<PlanningScene> scenes = scenes_of(options);
  std::vector<PlanningRun> runs;
  const std::size_t total = scenes.size() * options.problems * checkers(options.resolutions).size();
  {
    Progress progress("plan", total);
    for (PlanningScene& where : scenes) {
      if (!stop.has_come()) run_planning_scene(options, where, progress, stop, runs);
    }
  }
  const Json record = record_of(options, scenes, runs, runs.size() == total);
  if (auto* const csv = outputs.stream("--csv")) print_csv(*csv, flat(record["runs"]));
  write_record(outputs, record, options.files, std::cerr);
  print_wrapped(out, record["subject"]);
  for (const Json& text : record["account"]) print_wrapped(out, text);
  out << '\n';
  print_table(out, summaries(runs));
  if (stop.has_come()) {
    out << "\ninterrupted: " << runs.size() << " of " << total << " runs are finished\n";
  }
  out << '\n';
  print_wrapped(out, record["headline"]);
  if (invalid_of_keepout(runs) > 0) return EXIT_FAILURE;
  return stop.has_come() ? exit_interrupted : EXIT_SUCCESS;
}

}  // namespace keepout::app
