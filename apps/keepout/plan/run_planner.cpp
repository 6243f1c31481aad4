// SPDX-License-Identifier: BSD-3-Clause
#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <utility>

#include "keepout/index/query.h"
#include "keepout/ompl/planning.h"
#include "plan/ompl_run.h"
#include "plan/planning_run.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

namespace base = ompl::base;

Vec3 point_of(const base::State* state) {
  const double* values = state->as<base::RealVectorStateSpace::StateType>()->values;
  return {values[0], values[1], values[2]};
}

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

void set_checkers(const base::SpaceInformationPtr& space, const PlanningTask& task,
                  CheckTimer& timer) {
  if (!task.checker.is_keepouts()) {
    // Between two places so far apart no distance falls by more than half of it.
    const double apart = task.checker.resolution * space->getStateSpace()->getMaximumExtent();
    const bool is_widened = task.checker.kind == Checker::Kind::widened;
    const double clearance = task.options.clearance() + (is_widened ? 0.5 * apart : 0.0);
    space->setStateValidityCheckingResolution(task.checker.resolution);
    const auto places = std::make_shared<ClearPlaces>(task.where.scene, clearance);
    const auto is_valid = [places, all = space.get()](const base::State* state) {
      return all->satisfiesBounds(state) && places->has(point_of(state));
    };
    set_timed_checkers(space, is_valid, nullptr, timer);
  } else {
    const auto checker = make_state_validity_checker(space, task.guards);
    const auto is_valid = [checker](const base::State* state) { return checker->isValid(state); };
    set_timed_checkers(space, is_valid, make_motion_validator(space, task.guards), timer);
  }
}

base::PlannerPtr planner_of(const PlanningTask& task, const base::SpaceInformationPtr& space) {
  const double range = task.options.range;
  if (!task.checker.slides()) return named_planner(task.planner(), space, range);
  base::PlannerPtr planner = make_sliding_connect(space, task.guards);
  if (range > 0.0) planner->params().setParam("range", std::to_string(range));
  return planner;
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
  set_planning_seed(task.options.seed + task.problem.number);
  const auto space = std::make_shared<base::SpaceInformation>(space_of(task.where.bounds));
  CheckTimer timer;
  set_checkers(space, task, timer);
  const base::PlannerPtr planner = planner_of(task, space);
  const Vec3 &start = task.problem.start, &goal = task.problem.goal;
  const SolvedPath path = solve(planner, {start.data(), 3}, {goal.data(), 3},
                                {task.options.seconds, task.options.simplify}, interrupted);
  PlannedPath result{.solved = path.solved,
                     .seconds = path.seconds,
                     .checking_seconds = timer.seconds,
                     .checks = timer.motions};
  for (const std::vector<double>& tip : path.states) result.points.emplace_back(tip.data());
  read_steering(planner, result);
  return result;
}

}  // namespace keepout::app
