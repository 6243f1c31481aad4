// SPDX-License-Identifier: BSD-3-Clause
#include "plan/ompl_run.h"

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
#include <utility>

#include "keepout/error.h"

namespace keepout::app {
namespace {

namespace base = ompl::base;
namespace geometric = ompl::geometric;

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

}  // namespace

void set_timed_checkers(const base::SpaceInformationPtr& space,
                        const base::StateValidityCheckerPtr& states,
                        base::MotionValidatorPtr motions, CheckTimer& timer) {
  space->setStateValidityChecker([states, &timer](const base::State* state) {
    return timer.time([&] { return states->isValid(state); });
  });
  if (!motions) motions = std::make_shared<base::DiscreteMotionValidator>(space);
  space->setMotionValidator(std::make_shared<TimedMotions>(space, std::move(motions), timer));
  space->setup();
}

void set_planning_seed(std::uint64_t seed) {
  ompl::msg::noOutputHandler();  // also of its complaint that a seed is set anew, which is meant
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(1 + seed % 0x7FFFFFFF));  // 0 would be none
}

base::PlannerPtr named_planner(const std::string& name, const base::SpaceInformationPtr& space,
                               double range) {
  const auto with_range = [range](const auto& planner) -> base::PlannerPtr {
    if (range > 0.0) planner->setRange(range);
    return planner;
  };
  if (name == "RRTConnect") return with_range(std::make_shared<geometric::RRTConnect>(space));
  if (name == "RRT") return with_range(std::make_shared<geometric::RRT>(space));
  // These have no range.
  if (name == "PRM") return std::make_shared<geometric::PRM>(space);
  if (name == "BITstar") return std::make_shared<geometric::BITstar>(space);
  throw Error("plan: there is no planner '" + name + "'");
}

SolvedPath solve(const base::PlannerPtr& planner, const PlanningProblem& problem,
                 const PlanOptions& options, const std::function<bool()>& interrupted) {
  const base::SpaceInformationPtr& space = planner->getSpaceInformation();
  base::ScopedState<base::RealVectorStateSpace> from(space), to(space);
  std::ranges::copy(problem.start, from->values);
  std::ranges::copy(problem.goal, to->values);
  const auto definition = std::make_shared<base::ProblemDefinition>(space);
  definition->setStartAndGoalStates(from, to);
  // Planners that go on for a shorter path are to stop at the first.
  const auto objective = std::make_shared<base::PathLengthOptimizationObjective>(space);
  objective->setCostThreshold(objective->infiniteCost());
  definition->setOptimizationObjective(objective);

  planner->setProblemDefinition(definition);
  planner->setup();
  const auto begin = std::chrono::steady_clock::now();
  const auto gone = [begin] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  const base::PlannerTerminationCondition stop(
      [&] { return gone() > options.seconds || interrupted(); });
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
  return result;
}

}  // namespace keepout::app
