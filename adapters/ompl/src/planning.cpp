// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/ompl/planning.h"

#include <ompl/base/SpaceInformation.h>
#include <ompl/base/goals/GoalSampleableRegion.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/datastructures/NearestNeighbors.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "certified_checkers.h"
#include "keepout/error.h"
#include "keepout/ompl/straight_way.h"

namespace keepout {
namespace {

namespace base = ompl::base;

/// Returns the position of a state of three real numbers.
Vec3 tip_of(const base::State* state) noexcept {
  const double* values = state->as<base::RealVectorStateSpace::StateType>()->values;
  return {values[0], values[1], values[2]};
}

void put(const Vec3& tip, base::State* state) noexcept {
  double* values = state->as<base::RealVectorStateSpace::StateType>()->values;
  values[0] = tip.x();
  values[1] = tip.y();
  values[2] = tip.z();
}

/// Throws Error unless the space is one of tips and there is a pool.
void require_tip_space(const std::shared_ptr<base::SpaceInformation>& space,
                       const std::shared_ptr<GuardPool>& guards) {
  if (!space) throw Error("planning: there is no SpaceInformation");
  if (!guards) throw Error("planning: there is no GuardPool; make one with std::make_shared");
  const auto* real = dynamic_cast<const base::RealVectorStateSpace*>(space->getStateSpace().get());
  if (real == nullptr || real->getDimension() != 3) {
    throw Error(
        "planning: '" + space->getStateSpace()->getName() + "' has " +
        std::to_string(space->getStateDimension()) +
        " dimensions and is not a RealVectorStateSpace of 3: plan for the tip, in the frame "
        "of the mesh, in std::make_shared<ompl::base::RealVectorStateSpace>(3)");
  }
  const base::RealVectorBounds& bounds = real->getBounds();
  for (unsigned int i = 0; i < 3; ++i) {
    const bool is_finite = std::isfinite(bounds.low[i]) && std::isfinite(bounds.high[i]);
    if (!is_finite || !(bounds.low[i] < bounds.high[i])) {
      throw Error("planning: the bounds of '" + real->getName() + "' are not set along axis " +
                  std::to_string(i) +
                  ": give it setBounds(), low below high, around the part of the mesh to plan in");
    }
  }
}

/// Returns the bounds of a space of tips.
Box bounds_of(const base::SpaceInformation& space) {
  const auto& bounds = space.getStateSpace()->as<base::RealVectorStateSpace>()->getBounds();
  return {Vec3(bounds.low[0], bounds.low[1], bounds.low[2]),
          Vec3(bounds.high[0], bounds.high[1], bounds.high[2])};
}

/// The proofs for a tip: see certified_checkers.h.
struct TipProof {
  std::shared_ptr<GuardPool> guards;

  bool stands(const base::State* state) const {
    return keeps_margin(*guards->borrow(), tip_of(state));
  }
  bool goes(const base::State* from, const base::State* to) const {
    return proves(*guards->borrow(), tip_of(from), tip_of(to));
  }
  double goes_until(const base::State* from, const base::State* to, base::State* end) const {
    const ProvenPrefix prefix = proven_prefix(*guards->borrow(), tip_of(from), tip_of(to));
    put(prefix.end, end);
    return prefix.fraction;
  }
};

/// See make_sliding_connect. OMPL's planner with another way to grow its trees. Each motion in a
/// tree is connected to its parent by a proven step, in one direction or the other.
class SlidingConnect final : public ompl::geometric::RRTConnect {
 public:
  SlidingConnect(const base::SpaceInformationPtr& space, std::shared_ptr<GuardPool> guards,
                 const SteerOptions& options)
      : RRTConnect(space), guards_(std::move(guards)), options_(options) {
    setName("SlidingConnect");
    specs_.approximateSolutions = false;
    params_.remove("intermediate_states");          // all states of a path are in the tree
    ProjectingSteer(*guards_->borrow(), options_);  // throws for invalid options
    addPlannerProgressProperty("steering time REAL", [this] { return std::to_string(steering_); });
    addPlannerProgressProperty("ways INTEGER", [this] { return std::to_string(ways_); });
  }

  void setup() override {
    require_tip_space(si_, guards_);
    RRTConnect::setup();
  }

  void clear() override {
    RRTConnect::clear();
    steering_ = 0.0;
    ways_ = 0;
  }

  base::PlannerStatus solve(const base::PlannerTerminationCondition& stop) override;

 private:
  using Steer = std::function<ProjectingSteer::Way(const Vec3&, const Vec3&, double)>;

  Motion* add(const TreeData& tree, const Vec3& tip, Motion* parent) const {
    auto motion = std::make_unique<Motion>(si_);
    put(tip, motion->state);
    motion->parent = parent;
    motion->root = parent != nullptr ? parent->root : motion->state;
    tree->add(motion.get());
    return motion.release();  // OMPL frees the motions in a tree
  }

  /// Adds the path, which starts at `from`. Returns the motion at its end.
  Motion* add_way(const TreeData& tree, Motion* from, std::span<const Vec3> way) const {
    for (const Vec3& tip : way.subspan(1)) from = add(tree, tip, from);
    return from;
  }

  /// Makes one iteration from one of the trees. Returns true if it met the other tree.
  bool grow(const Steer& steer, const TreeData& tree, const TreeData& other, Motion& sample,
            Motion*& end, Motion*& end_of_other) const;
  void add_solution(const Motion* from_start, const Motion* from_goal);

  std::shared_ptr<GuardPool> guards_;
  SteerOptions options_;
  double steering_ = 0.0;  // [s]
  std::size_t ways_ = 0;   // number of steered paths
};

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
  // The last state of one tree is the first of the other.
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

  // The space's own checker may be any, so this also tests the states that it accepts.
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

std::shared_ptr<base::StateValidityChecker> make_state_validity_checker(
    const std::shared_ptr<base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards) {
  require_tip_space(space, guards);
  return std::make_shared<CertifiedStates<TipProof>>(space, TipProof{std::move(guards)});
}

std::shared_ptr<base::MotionValidator> make_motion_validator(
    const std::shared_ptr<base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards) {
  require_tip_space(space, guards);
  return std::make_shared<CertifiedMotions<TipProof>>(space, TipProof{std::move(guards)});
}

void set_certified_checkers(const std::shared_ptr<base::SpaceInformation>& space,
                            const std::shared_ptr<GuardPool>& guards) {
  const auto states = make_state_validity_checker(space, guards);
  const auto motions = make_motion_validator(space, guards);
  space->setStateValidityChecker(states);
  space->setMotionValidator(motions);
}

std::shared_ptr<base::Planner> make_sliding_connect(
    const std::shared_ptr<base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards,
    const SteerOptions& options) {
  require_tip_space(space, guards);
  return std::make_shared<SlidingConnect>(space, std::move(guards), options);
}

}  // namespace keepout
