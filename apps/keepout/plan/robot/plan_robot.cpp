// SPDX-License-Identifier: BSD-3-Clause
#include "plan/robot/plan_robot.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <ostream>
#include <utility>

#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/ompl/joint_planning.h"
#include "plan/ompl_run.h"
#include "record/flat_rows.h"
#include "shared/named_mesh.h"
#include "shared/output_file.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"
#include "shared/wrapped_text.h"

namespace keepout::app {
namespace {

namespace base = ompl::base;

/// What a planner is run with on a problem: all checkers ask the same guards.
struct RobotPlanningTask {
  const PlanOptions& options;
  const RobotProblem& problem;
  std::shared_ptr<InstrumentPool> guards;
};

void set_robot_checkers(const base::SpaceInformationPtr& space, const RobotPlanningTask& task,
                        const Checker& checker, CheckTimer& timer) {
  const auto states = make_state_validity_checker(space, task.guards);
  const auto is_valid = [states](const base::State* state) { return states->isValid(state); };
  base::MotionValidatorPtr motions;
  if (checker.is_keepouts()) motions = make_motion_validator(space, task.guards);
  if (!motions) space->setStateValidityCheckingResolution(checker.resolution);
  set_timed_checkers(space, is_valid, std::move(motions), timer);
}

RobotPlanningRun run_on(const RobotPlanningTask& task, const Checker& checker, std::uint64_t seed,
                        const StopSignal& stop) {
  const Instrument instrument = task.guards->borrow()->instrument();
  set_planning_seed(seed);
  const auto space = std::make_shared<base::SpaceInformation>(make_joint_space(instrument));
  CheckTimer timer;
  set_robot_checkers(space, task, checker, timer);
  SolvedPath path =
      solve(named_planner(task.options.planner, space, task.options.range), task.problem.start,
            task.problem.goal, {task.options.seconds, task.options.simplify},
            [&stop] { return stop.has_come(); });
  RobotPlanningRun run{.mesh = {},
                       .checker = checker,
                       .problem = task.problem,
                       .seed = seed,
                       .solved = path.solved,
                       .seconds = path.seconds,
                       .checking_seconds = timer.seconds,
                       .checks = timer.motions,
                       .path = std::move(path.states)};
  base::ScopedState<> a(space), b(space);
  for (std::size_t i = 1; i < run.path.size(); ++i) {
    a = run.path[i - 1];
    b = run.path[i];
    run.length += a.distance(b);
  }
  return run;
}

std::vector<Checker> robot_checkers(const PlanOptions& options) {
  std::vector<Checker> all = checkers(options.resolutions);
  std::erase_if(all, [](const Checker& checker) {
    return checker.kind != Checker::Kind::sampled && checker.kind != Checker::Kind::certified;
  });
  return all;
}

std::vector<std::filesystem::path> meshes_of(const PlanOptions& options) {
  if (options.mesh) return {*options.mesh};
  return {"airway", "skull"};
}

void run_scene(const PlanOptions& options, Scene& scene, Progress& progress, const StopSignal& stop,
               std::vector<RobotPlanningRun>& runs) {
  const RobotUnderTest& robot = robot_named(options.robot);
  progress.show(scene.name() + ", drawing problems");
  for (const RobotProblem& problem :
       draw_robot_problems(scene, robot, options.margin, options.problems, options.seed)) {
    const auto guards = std::make_shared<InstrumentPool>([&] {
      return make_instrument_constraint(scene.mesh(), scene.shared_index(),
                                        robot.make(problem.base),
                                        {.options = {.margin = options.margin}});
    });
    oracle::InstrumentOracle oracle(scene.tree(), robot.judged(), problem.base);
    for (const Checker& checker : robot_checkers(options)) {
      progress.show(scene.name() + " " + std::to_string(problem.number) + ", " + checker.name());
      for (std::size_t i = 0; i < options.seeds; ++i) {
        if (stop.has_come()) return;
        RobotPlanningRun run = run_on({options, problem, guards}, checker, options.seed + i, stop);
        // Cut short it tells nothing.
        if (stop.has_come() && !run.solved) return;
        run.mesh = scene.name();
        run.verdict = judge_joint_path(oracle, *guards->borrow(), run.path);
        runs.push_back(std::move(run));
        progress.advance();
      }
    }
  }
}

bool is_broken_promise(const RobotPlanningRun& run) {
  return run.checker.is_keepouts() && run.solved && !run.is_valid();
}

}  // namespace

int plan_with_robot(const PlanOptions& options, std::ostream& out) {
  std::vector<NamedPath> inputs;
  if (options.mesh) inputs.push_back({"MESH", file_of_mesh(*options.mesh)});
  OutputFiles outputs(inputs, {{"--json", options.files.kept_json()},
                               {"--csv", options.csv},
                               {"--out", options.files.page}});
  const StopSignal stop;  // after the files, which a second signal removes
  std::vector<Scene> scenes;
  for (const std::filesystem::path& mesh : meshes_of(options)) {
    scenes.emplace_back(mesh.filename().string(), load_named_mesh(mesh).mesh, "wide_bvh");
  }
  const std::size_t total =
      scenes.size() * options.problems * options.seeds * robot_checkers(options).size();
  std::vector<RobotPlanningRun> runs;
  {
    Progress progress("plan", total);
    for (Scene& scene : scenes) {
      if (!stop.has_come()) run_scene(options, scene, progress, stop, runs);
    }
  }
  const Json record = robot_record_of(options, runs, runs.size() == total);
  if (auto* const csv = outputs.stream("--csv")) print_csv(*csv, flat(record["runs"]));
  write_record(outputs, record, options.files, std::cerr);
  print_wrapped(out, record["subject"]);
  for (const Json& text : record["account"]) print_wrapped(out, text);
  out << '\n';
  print_robot_summaries(out, record["summaries"]);
  if (stop.has_come()) {
    out << "\ninterrupted: " << runs.size() << " of " << total << " runs are finished\n";
  }
  out << '\n';
  print_wrapped(out, record["headline"]);
  if (std::ranges::any_of(runs, &is_broken_promise)) return EXIT_FAILURE;
  return stop.has_come() ? exit_interrupted : EXIT_SUCCESS;
}

}  // namespace keepout::app
