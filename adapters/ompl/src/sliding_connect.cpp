// SPDX-License-Identifier: BSD-3-Clause
#include <ompl/base/goals/GoalSampleableRegion.h>
#include <ompl/datastructures/NearestNeighbors.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "keepout/error.h"
#include "keepout/ompl/planning.h"
#include "keepout/ompl/straight_way.h"
#include "tip_space.h"

namespace keepout {
namespace {

namespace base = ompl::base;

/// See make_sliding_connect. OMPL's planner with another way to grow its trees: a proven step leads
/// to each of their motions from its parent, or away from it, which is the same line.
class SlidingConnect final : public ompl::geometric::RRTConnect {
 public:
  SlidingConnect(const base::SpaceInformationPtr& space, std::shared_ptr<GuardPool> guards,
                 const SteerOptions& options);

  void setup() override;
  void clear() override;
  base::PlannerStatus solve(const base::PlannerTerminationCondition& stop) override;

 private:
  using Steer = std::function<ProjectingSteer::Way(const Vec3&, const Vec3&, double)>;

  Motion* add(const TreeData& tree, const Vec3& tip, Motion* parent) const;
  /// The motion at the end of the way, which starts at `from`.
  Motion* add_way(const TreeData& tree, Motion* from, std::span<const Vec3> way) const;
  /// One iteration from one of the trees; whether it met the other.
  bool grow(const Steer& steer, const TreeData& tree, const TreeData& other, Motion& sample,
            Motion*& end, Motion*& end_of_other) const;
  void add_solution(const Motion* from_start, const Motion* from_goal);

  std::shared_ptr<GuardPool> guards_;
  SteerOptions options_;
  double steering_ = 0.0;  // [s]
  std::size_t ways_ = 0;   // steered
};

SlidingConnect::SlidingConnect(const base::SpaceInformationPtr& space,
                               std::shared_ptr<GuardPool> guards, const SteerOptions& options)
    : RRTConnect(space), guards_(std::move(guards)), options_(options) {
  setName("SlidingConnect");
  specs_.approximateSolutions = false;
  params_.remove("intermediate_states");          // all of a way are in the tree
  ProjectingSteer(*guards_->borrow(), options_);  // what is wrong with the options is thrown here
  addPlannerProgressProperty("steering time REAL", [this] { return std::to_string(steering_); });
  addPlannerProgressProperty("ways INTEGER", [this] { return std::to_string(ways_); });
}

void SlidingConnect::setup() {
  require_tip_space(si_, guards_);
  RRTConnect::setup();
}

void SlidingConnect::clear() {
  RRTConnect::clear();
  steering_ = 0.0;
  ways_ = 0;
}

SlidingConnect::Motion* SlidingConnect::add(const TreeData& tree, const Vec3& tip,
                                            Motion* parent) const {
  auto motion = std::make_unique<Motion>(si_);
  put(tip, motion->state);
  motion->parent = parent;
  motion->root = parent != nullptr ? parent->root : motion->state;
  tree->add(motion.get());
  return motion.release();  // OMPL lets go of what is in a tree
}

SlidingConnect::Motion* SlidingConnect::add_way(const TreeData& tree, Motion* from,
                                                std::span<const Vec3> way) const {
  for (const Vec3& tip : way.subspan(1)) from = add(tree, tip, from);
  return from;
}

bool SlidingConnect::grow(const Steer& steer, const TreeData& tree, const TreeData& other,
                          Motion& sample, Motion*& end, Motion*& end_of_other) const {
  Motion* const near = tree->nearest(&sample);
  const ProjectingSteer::Way way = steer(tip_of(near->state), tip_of(sample.state), maxDistance_);
  if (way.points.size() < 2) return false;
  end = add_way(tree, near, way.points);
  Motion* const near_in_other = other->nearest(end);
  const ProjectingSteer::Way back = steer(tip_of(near_in_other->state), tip_of(end->state),
                                          std::numeric_limits<double>::infinity());
  end_of_other = add_way(other, near_in_other, back.points);
  return back.ending == ProjectingSteer::Ending::arrived;
}

void SlidingConnect::add_solution(const Motion* from_start, const Motion* from_goal) {
  connectionPoint_ = {from_start->state, from_goal->state};
  distanceBetweenTrees_ = 0.0;
  std::vector<const base::State*> states;
  for (; from_start != nullptr; from_start = from_start->parent) {
    states.push_back(from_start->state);
  }
  std::reverse(states.begin(), states.end());
  // Both ends are the same place.
  while ((from_goal = from_goal->parent) != nullptr) states.push_back(from_goal->state);
  const auto path = std::make_shared<ompl::geometric::PathGeometric>(si_);
  for (const base::State* state : states) path->append(state);
  pdef_->addSolutionPath(path, false, 0.0, getName());
}

base::PlannerStatus SlidingConnect::solve(const base::PlannerTerminationCondition& stop) {
  checkValidity();
  auto* const region = dynamic_cast<base::GoalSampleableRegion*>(pdef_->getGoal().get());
  if (region == nullptr) return base::PlannerStatus::UNRECOGNIZED_GOAL_TYPE;
  const GuardPool::Loan guard = guards_->borrow();
  ProjectingSteer projecting(*guard, options_);
  const auto steer = [&, bounds = bounds_of(*si_)](const Vec3& from, const Vec3& to,
                                                   double longest) {
    const auto begin = std::chrono::steady_clock::now();
    const ProjectingSteer::Way way = projecting.steer(from, to, longest, bounds);
    steering_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    ++ways_;
    return way;
  };

  // The space's own checker may be anything: what it lets pass is asked about here as well.
  while (const base::State* state = pis_.nextStart()) {
    if (keeps_margin(*guard, tip_of(state))) add(tStart_, tip_of(state), nullptr);
  }
  if (tStart_->size() == 0) return base::PlannerStatus::INVALID_START;
  if (!region->couldSample()) return base::PlannerStatus::INVALID_GOAL;
  if (!sampler_) sampler_ = si_->allocStateSampler();

  Motion sample(si_);
  base::PlannerStatus status = base::PlannerStatus::TIMEOUT;
  for (std::size_t iteration = 0; !stop; ++iteration) {
    if (tGoal_->size() == 0 || pis_.getSampledGoalsCount() < tGoal_->size() / 2) {
      const base::State* state = tGoal_->size() == 0 ? pis_.nextGoal(stop) : pis_.nextGoal();
      if (state != nullptr && keeps_margin(*guard, tip_of(state))) {
        add(tGoal_, tip_of(state), nullptr);
      }
      if (tGoal_->size() == 0) {
        status = base::PlannerStatus::INVALID_GOAL;
        if (state == nullptr) break;
        continue;
      }
      status = base::PlannerStatus::TIMEOUT;
    }
    sampler_->sampleUniform(sample.state);
    Motion* from_start = nullptr;
    Motion* from_goal = nullptr;
    const bool has_met = iteration % 2 == 0
                             ? grow(steer, tStart_, tGoal_, sample, from_start, from_goal)
                             : grow(steer, tGoal_, tStart_, sample, from_goal, from_start);
    if (has_met) {
      add_solution(from_start, from_goal);
      status = base::PlannerStatus::EXACT_SOLUTION;
      break;
    }
  }
  si_->freeState(sample.state);
  return status;
}

}  // namespace

std::shared_ptr<base::Planner> make_sliding_connect(
    const std::shared_ptr<base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards,
    const SteerOptions& options) {
  require_tip_space(space, guards);
  return std::make_shared<SlidingConnect>(space, std::move(guards), options);
}

}  // namespace keepout
