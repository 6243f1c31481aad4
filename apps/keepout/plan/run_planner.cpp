// SPDX-License-Identifier: BSD-3-Clause
#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/SpaceInformation.h>
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

#include <chrono>
#include <utility>

#include "keepout/error.h"
#include "keepout/index/query.h"
#include "keepout/ompl/planning.h"
#include "number_text.h"
#include "plan/planning_run.h"

namespace keepout::app {
namespace {

namespace base = ompl::base;
namespace geometric = ompl::geometric;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Vec3 point_of(const base::State* state) {
  const double* values = state->as<base::RealVectorStateSpace::StateType>()->values;
  return {values[0], values[1], values[2]};
}

/// Time spent in checking. What is checked on the way of a check is part of it.
struct Timer {
  bool running = false;
  double seconds = 0.0;
  std::uint64_t motions = 0;

  template <class Check>
  bool time(const Check& check) {
    if (running) return check();
    running = true;
    const Clock::time_point start = Clock::now();
    const bool result = check();
    seconds += seconds_since(start);
    running = false;
    return result;
  }
};

/// What a user of OMPL would write: no triangle within the clearance, by the fastest index here.
/// Which side a place is on is not asked: that would only cost time, as a tree starts on the right
/// one. For one thread.
class ClearPlaces {
 public:
  ClearPlaces(const Scene& scene, double clearance)
      : scene_(&scene),
        clearance_(clearance),
        candidates_(scene.mesh()->triangle_count()),
        hits_(scene.mesh()->triangle_count()) {}

  bool has(const Vec3& point) {
    const Ball ball{point, clearance_};
    candidates_.clear();
    scene_->index().collect(ball, candidates_);
    if (candidates_.view().empty()) return true;
    hits_.clear();
    refine(*scene_->mesh(), ball, candidates_.view(), hits_);
    return hits_.view().empty();
  }

 private:
  const Scene* scene_;
  double clearance_;
  TriangleBuffer candidates_;
  HitBuffer hits_;
};

class TimedMotions final : public base::MotionValidator {
 public:
  TimedMotions(const base::SpaceInformationPtr& space, base::MotionValidatorPtr validator,
               Timer& timer)
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
  Timer* timer_;
};

base::StateSpacePtr space_of(const Box& bounds) {
  auto space = std::make_shared<base::RealVectorStateSpace>(3);
  base::RealVectorBounds limits(3);
  for (unsigned int i = 0; i < 3; ++i) {
    limits.setLow(i, bounds.low[i]);
    limits.setHigh(i, bounds.high[i]);
  }
  space->setBounds(limits);
  return space;
}

void set_checkers(const base::SpaceInformationPtr& space, const PlanningTask& task, Timer& timer) {
  if (!task.checker.is_keepouts()) {
    // Between two places so far apart no distance falls by more than half of it.
    const double apart = task.checker.resolution * space->getStateSpace()->getMaximumExtent();
    const bool is_widened = task.checker.kind == Checker::Kind::widened;
    const double clearance = task.options.clearance() + (is_widened ? 0.5 * apart : 0.0);
    space->setStateValidityCheckingResolution(task.checker.resolution);
    const auto places = std::make_shared<ClearPlaces>(task.where.scene, clearance);
    space->setStateValidityChecker([places, &timer, all = space.get()](const base::State* state) {
      return timer.time(
          [&] { return all->satisfiesBounds(state) && places->has(point_of(state)); });
    });
    space->setMotionValidator(std::make_shared<TimedMotions>(
        space, std::make_shared<base::DiscreteMotionValidator>(space), timer));
  } else {
    const auto checker = make_state_validity_checker(space, task.guards);
    space->setStateValidityChecker([checker, &timer](const base::State* state) {
      return timer.time([&] { return checker->isValid(state); });
    });
    space->setMotionValidator(
        std::make_shared<TimedMotions>(space, make_motion_validator(space, task.guards), timer));
  }
  space->setup();
}

base::PlannerPtr planner_of(const PlanningTask& task, const base::SpaceInformationPtr& space) {
  const double range = task.options.range;
  const auto with_range = [range](const auto& planner) -> base::PlannerPtr {
    if (range > 0.0) planner->setRange(range);
    return planner;
  };
  const std::string name = task.planner();
  if (name == "SlidingConnect") {
    base::PlannerPtr planner = make_sliding_connect(space, task.guards);
    if (range > 0.0) planner->params().setParam("range", std::to_string(range));
    return planner;
  }
  if (name == "RRTConnect") return with_range(std::make_shared<geometric::RRTConnect>(space));
  if (name == "RRT") return with_range(std::make_shared<geometric::RRT>(space));
  // These have no range.
  if (name == "PRM") return std::make_shared<geometric::PRM>(space);
  if (name == "BITstar") return std::make_shared<geometric::BITstar>(space);
  throw Error("plan: there is no planner '" + name + "'");
}

/// What the planner that steers by itself tells of it.
void read_steering(const base::PlannerPtr& planner, PlannedPath& path) {
  const auto& properties = planner->getPlannerProgressProperties();
  const auto seconds = properties.find("steering time REAL");
  const auto ways = properties.find("ways INTEGER");
  if (seconds != properties.end()) path.checking_seconds += std::stod(seconds->second());
  if (ways != properties.end()) path.checks += std::stoull(ways->second());
}

}  // namespace

std::string Checker::name() const {
  switch (kind) {
    case Kind::sampled:
      return "sampled " + trimmed(100.0 * resolution) + " %";
    case Kind::widened:
      return "widened " + trimmed(100.0 * resolution) + " %";
    case Kind::certified:
      return "certified";
    case Kind::sliding:
      return "sliding";
  }
  return {};
}

std::vector<Checker> checkers(std::span<const double> resolutions) {
  std::vector<Checker> all;
  for (const Checker::Kind kind : {Checker::Kind::sampled, Checker::Kind::widened}) {
    for (const double resolution : resolutions) all.push_back({kind, resolution});
  }
  all.push_back({Checker::Kind::certified});
  all.push_back({Checker::Kind::sliding});
  return all;
}

PlannedPath run_planner(const PlanningTask& task, const std::function<bool()>& interrupted) {
  const std::uint64_t seed = task.options.seed + task.problem.number;
  ompl::msg::noOutputHandler();  // also of its complaint that a seed is set anew, which is meant
  // All generators that OMPL makes from here on have their seeds from this one; 0 would be none.
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(1 + seed % 0x7FFFFFFF));
  const auto space = std::make_shared<base::SpaceInformation>(space_of(task.where.bounds));
  Timer timer;
  set_checkers(space, task, timer);

  base::ScopedState<base::RealVectorStateSpace> start(space), goal(space);
  for (unsigned int i = 0; i < 3; ++i) {
    start[i] = task.problem.start[i];
    goal[i] = task.problem.goal[i];
  }
  const auto definition = std::make_shared<base::ProblemDefinition>(space);
  definition->setStartAndGoalStates(start, goal);
  // Planners that go on for a shorter path are to stop at the first.
  const auto objective = std::make_shared<base::PathLengthOptimizationObjective>(space);
  objective->setCostThreshold(objective->infiniteCost());
  definition->setOptimizationObjective(objective);

  const base::PlannerPtr planner = planner_of(task, space);
  planner->setProblemDefinition(definition);
  planner->setup();
  const Clock::time_point begin = Clock::now();
  const base::PlannerTerminationCondition stop(
      [&] { return seconds_since(begin) > task.options.seconds || interrupted(); });
  planner->solve(stop);

  PlannedPath result;
  result.solved = definition->hasExactSolution();
  if (result.solved) {
    auto& path = *definition->getSolutionPath()->as<geometric::PathGeometric>();
    if (task.options.simplify) geometric::PathSimplifier(space).simplify(path, stop);
    for (const base::State* state : path.getStates()) result.points.push_back(point_of(state));
  }
  result.seconds = seconds_since(begin);
  result.checking_seconds = timer.seconds;
  result.checks = timer.motions;
  read_steering(planner, result);
  return result;
}

}  // namespace keepout::app
