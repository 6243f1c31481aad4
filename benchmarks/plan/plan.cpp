// SPDX-License-Identifier: BSD-3-Clause
#include "plan/plan.h"

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <ostream>
#include <utility>

#include "keepout/error.h"
#include "plan/planning.h"
#include "record/flat_rows.h"
#include "shared/named_mesh.h"
#include "shared/number_text.h"
#include "shared/progress.h"
#include "shared/robot_file.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

namespace base = ompl::base;
namespace geometric = ompl::geometric;

/// The time spent in checks. A check inside a check is not counted twice.
struct CheckTimer {
  bool running = false;
  double seconds = 0.0;
  std::uint64_t motions = 0;

  template <class Check>
  bool time(const Check& check) {
    if (running) return check();
    running = true;
    const auto start = std::chrono::steady_clock::now();
    const bool result = check();
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    running = false;
    return result;
  }
};

class TimedMotions final : public base::MotionValidator {
 public:
  TimedMotions(const base::SpaceInformationPtr& space, base::MotionValidatorPtr validator,
               CheckTimer& timer)
      : MotionValidator(space), validator_(std::move(validator)), timer_(&timer) {}

  bool checkMotion(const base::State* from, const base::State* to) const override {
    ++timer_->motions;
    return timer_->time([&] { return validator_->checkMotion(from, to); });
  }

  bool checkMotion(const base::State* from, const base::State* to,
                   std::pair<base::State*, double>& last_valid) const override {
    ++timer_->motions;
    return timer_->time([&] { return validator_->checkMotion(from, to, last_valid); });
  }

 private:
  base::MotionValidatorPtr validator_;
  CheckTimer* timer_;
};

/// Returns a space with timed checks. The timer must outlive the space.
base::SpaceInformationPtr space_with(Planning& planning, const Checker& checker,
                                     CheckTimer& timer) {
  const auto space = std::make_shared<base::SpaceInformation>(planning.space());
  auto [states, motions] = planning.checks(space, checker);
  space->setStateValidityChecker([states = states, &timer](const base::State* state) {
    return timer.time([&] { return states->isValid(state); });
  });
  if (!motions) {
    space->setStateValidityCheckingResolution(checker.resolution);
    motions = std::make_shared<base::DiscreteMotionValidator>(space);
  }
  space->setMotionValidator(std::make_shared<TimedMotions>(space, std::move(motions), timer));
  space->setup();
  return space;
}

/// Returns the planner of one of the names ompl_planners. Throws Error for another name.
base::PlannerPtr named_planner(const std::string& name, const base::SpaceInformationPtr& space) {
  if (name == "RRTConnect") return std::make_shared<geometric::RRTConnect>(space);
  if (name == "RRT") return std::make_shared<geometric::RRT>(space);
  if (name == "PRM") return std::make_shared<geometric::PRM>(space);
  if (name == "BITstar") return std::make_shared<geometric::BITstar>(space);
  throw Error("plan: there is no planner '" + name + "'");
}

/// Returns a planner with the range of the options, if the planner has a range.
base::PlannerPtr planner_of(Planning& planning, const Checker& checker, const PlanOptions& options,
                            const base::SpaceInformationPtr& space) {
  const base::PlannerPtr planner =
      checker.slides() ? planning.sliding(space) : named_planner(options.planner, space);
  if (options.range > 0.0 && planner->params().hasParam("range")) {
    planner->params().setParam("range", formatted("%.17g", options.range));
  }
  return planner;
}

base::ProblemDefinitionPtr definition_of(const PlanningProblem& problem,
                                         const base::SpaceInformationPtr& space) {
  base::ScopedState<base::RealVectorStateSpace> from(space), to(space);
  std::ranges::copy(problem.start, from->values);
  std::ranges::copy(problem.goal, to->values);
  const auto definition = std::make_shared<base::ProblemDefinition>(space);
  definition->setStartAndGoalStates(from, to);
  // Planners that optimize must stop at their first path.
  const auto objective = std::make_shared<base::PathLengthOptimizationObjective>(space);
  objective->setCostThreshold(objective->infiniteCost());
  definition->setOptimizationObjective(objective);
  return definition;
}

/// The result of a search for a path.
struct SolvedPath {
  Path states = {};               // empty unless solved
  double seconds = 0.0;           // of the planner, and of the simplifier
  double checking_seconds = 0.0;  // of these, the time in checks
  std::uint64_t checks = 0;       // of motions
};

/// Adds the steering time and count that a planner reports; most planners report none.
void add_steering(const base::Planner& planner, SolvedPath& path) {
  const auto& properties = planner.getPlannerProgressProperties();
  const auto seconds = properties.find("steering time REAL");
  const auto ways = properties.find("ways INTEGER");
  if (seconds != properties.end()) path.checking_seconds += std::stod(seconds->second());
  if (ways != properties.end()) path.checks += std::stoull(ways->second());
}

/// Searches for the first path with the planner of the options under a checker, in a new space, and
/// simplifies it if the options say so. The same seed gives the same path unless time runs out. Not
/// thread-safe: OMPL has one seed for the process.
SolvedPath solve(Planning& planning, const Checker& checker, const PlanningProblem& problem,
                 const PlanOptions& options, std::uint64_t seed, const StopSignal& stop_signal) {
  ompl::msg::noOutputHandler();  // hides OMPL's warning about a changed seed, which is intended
  ompl::RNG::setSeed(
      static_cast<std::uint_fast32_t>(1 + seed % 0x7FFFFFFF));  // 0 would not set a seed
  CheckTimer timer;
  const base::SpaceInformationPtr space = space_with(planning, checker, timer);
  const base::PlannerPtr planner = planner_of(planning, checker, options, space);
  const base::ProblemDefinitionPtr definition = definition_of(problem, space);
  planner->setProblemDefinition(definition);
  planner->setup();
  const auto begin = std::chrono::steady_clock::now();
  const auto gone = [begin] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  const base::PlannerTerminationCondition stop(
      [&] { return gone() > options.seconds || stop_signal.has_come(); });
  planner->solve(stop);

  SolvedPath result;
  if (definition->hasExactSolution()) {
    auto& path = *definition->getSolutionPath()->as<geometric::PathGeometric>();
    if (options.simplify) geometric::PathSimplifier(space).simplify(path, stop);
    for (const base::State* state : path.getStates()) {
      const double* values = state->as<base::RealVectorStateSpace::StateType>()->values;
      result.states.emplace_back(values, values + problem.start.size());
    }
  }
  result.seconds = gone();
  result.checking_seconds = timer.seconds;
  result.checks = timer.motions;
  add_steering(*planner, result);
  return result;
}

/// Runs the planner of the options and judges the path.
Json run_planner(const PlanOptions& options, Planning& planning, const PlanningProblem& problem,
                 const Checker& checker, std::size_t repetition, const StopSignal& stop) {
  const bool is_tip = options.robot.empty();
  const std::uint64_t seed = options.seed + (is_tip ? problem.number : repetition);
  const SolvedPath path = solve(planning, checker, problem, options, seed, stop);
  Json run{{"mesh", planning.scene().name()}, {"problem", problem.number}};
  if (is_tip) {
    run.update(problem.members);
    run["checker"] = checker.name();
    run["planner"] = checker.slides() ? "SlidingConnect" : options.planner;
  } else {
    run["seed"] = seed;
    run["checker"] = checker.name();
    run.update(problem.members);
  }
  const bool is_solved = !path.states.empty();
  run["solved"] = is_solved;
  run["seconds"] = path.seconds;
  run["checking_seconds"] = path.checking_seconds;
  run["checks"] = path.checks;
  // An unsolved run has the same members, null, but no path.
  Json found = planning.judge(is_solved ? path.states : Path{problem.start});
  if (!is_solved) {
    for (const char* list : {"path", "too_near"}) found.erase(list);
    for (Json& value : found) value = nullptr;
  }
  run.update(found);
  return run;
}

/// Adds all runs on a mesh, up to a stop.
void run_all(const PlanOptions& options, Planning& planning, Progress& progress,
             const StopSignal& stop, Json& runs) {
  const std::string& mesh = planning.scene().name();
  progress.show(mesh + ", drawing problems");
  for (const PlanningProblem& problem : planning.draw(stop)) {
    planning.open(problem);
    for (const Checker& checker : checkers_of(options)) {
      progress.show(mesh + " " + std::to_string(problem.number) + ", " + checker.name());
      for (std::size_t i = 0; i < options.repetitions(); ++i) {
        if (stop.has_come()) return;
        Json run = run_planner(options, planning, problem, checker, i, stop);
        // A run that was stopped has no result.
        if (stop.has_come() && !run["solved"]) return;
        runs.push_back(std::move(run));
        stop.keep_from_now_on();
        progress.advance();
      }
    }
  }
}

}  // namespace

int plan(const PlanOptions& options, std::ostream& out) {
  OutputFiles outputs =
      options.files.open(options.meshes, "MESH", robot_inputs(options.robot, options.bodies));
  // After the files: if a signal ends the process, they are removed.
  const StopSignal stop(keeps_what_is_finished, BeforeWork::ends_process);
  std::vector<std::filesystem::path> meshes = options.meshes;
  if (meshes.empty()) meshes = {"airway", "skull"};
  std::vector<std::unique_ptr<Planning>> plannings;
  for (const auto& mesh : meshes) {
    const std::shared_ptr<const Mesh> loaded = load_named_mesh(mesh).mesh;
    require_area(mesh.string(), *loaded);
    const auto make = options.robot.empty() ? planning_of_a_tip : planning_of_an_instrument;
    plannings.push_back(make(options, Scene(mesh.filename().string(), loaded, "wide_bvh")));
  }
  const std::size_t total =
      plannings.size() * options.problems * checkers_of(options).size() * options.repetitions();
  Json runs = Json::array();
  {
    Progress progress("plan", total);
    for (const auto& planning : plannings) {
      if (!stop.has_come()) run_all(options, *planning, progress, stop, runs);
    }
  }
  const bool is_complete = runs.size() == total;
  const Json record = record_of(options, plannings, std::move(runs), is_complete);
  const Json& all = record["runs"];
  if (auto* const csv = outputs.stream("--csv")) print_csv(*csv, flat(all));
  write_record(outputs, record, options.files);
  print_wrapped(out, record["subject"]);
  out << '\n';
  print_summaries(out, all);
  if (stop.has_come()) {
    out << "\ninterrupted: " << all.size() << " of " << total << " runs are finished\n";
  }
  out << '\n';
  print_wrapped(out, record["headline"]);
  const auto breaks_a_promise = [](const Json& run) {
    return is_keepouts(run) && run["solved"] && !is_valid(run);
  };
  if (std::ranges::any_of(all, breaks_a_promise)) return EXIT_FAILURE;
  if (stop.has_come()) return exit_interrupted;
  if (std::ranges::any_of(all, [](const Json& run) { return run["solved"].get<bool>(); })) {
    return EXIT_SUCCESS;
  }
  std::cerr << "keepout: no path was found, so nothing was tested: raise --seconds\n";
  return EXIT_FAILURE;
}

}  // namespace keepout::app
