// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <ompl/base/Planner.h>
#include <ompl/base/goals/GoalSampleableRegion.h>
#include <ompl/datastructures/NearestNeighbors.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/tools/config/SelfConfig.h>

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

constexpr double range_of_extent = 0.2;  // as OMPL's own planners have it

/// See make_sliding_connect.
class SlidingConnect final : public ompl::base::Planner {
 public:
  SlidingConnect(const ompl::base::SpaceInformationPtr& space, std::shared_ptr<GuardPool> guards,
                 const SteerOptions& options);

  void setRange(double range) { range_ = range; }
  double getRange() const { return range_; }

  void setup() override;
  void clear() override;
  ompl::base::PlannerStatus solve(const ompl::base::PlannerTerminationCondition& stop) override;
  void getPlannerData(ompl::base::PlannerData& data) const override;

 private:
  struct Node {
    Vec3 tip;
    const Node* parent = nullptr;        // none: a root
    ompl::base::State* state = nullptr;  // the tip, for planner data, which points at states
  };

  /// Nodes that a proven step leads to from their parents, or away from them: it is the same line.
  class Tree {
   public:
    explicit Tree(const ompl::base::SpaceInformationPtr& space) : space_(space.get()) {}
    ~Tree() { clear(); }
    Tree(const Tree&) = delete;
    Tree& operator=(const Tree&) = delete;

    void set_up(const ompl::base::Planner* planner);
    void clear();
    bool empty() const { return nodes_.empty(); }
    std::size_t size() const { return nodes_.size(); }
    Node* nearest(const Vec3& tip) const;
    void add_root(const Vec3& tip) { add(tip, nullptr); }
    /// The node at the end of the way, which starts at `from`.
    const Node* add_way(const Node* from, std::span<const Vec3> way);
    const std::vector<std::unique_ptr<Node>>& nodes() const { return nodes_; }

   private:
    Node* add(const Vec3& tip, const Node* parent);

    const ompl::base::SpaceInformation* space_;
    std::vector<std::unique_ptr<Node>> nodes_;
    std::shared_ptr<ompl::NearestNeighbors<Node*>> nearest_;
  };

  /// One iteration from one of the trees; whether it met the other.
  using Steer = std::function<ProjectingSteer::Way(const Vec3&, const Vec3&, double)>;
  bool grow(const Steer& steer, Tree& tree, Tree& other, const Vec3& towards, const Node*& end,
            const Node*& end_of_other) const;
  void add_solution(const Node* from_start, const Node* from_goal);

  std::shared_ptr<GuardPool> guards_;
  SteerOptions options_;
  double range_ = 0.0;  // [length]; 0: of the space's extent
  ompl::base::StateSamplerPtr sampler_;
  double steering_ = 0.0;  // [s]
  std::size_t ways_ = 0;   // steered
  Tree start_;
  Tree goal_;
};

void SlidingConnect::Tree::set_up(const base::Planner* planner) {
  if (!nearest_)
    nearest_.reset(ompl::tools::SelfConfig::getDefaultNearestNeighbors<Node*>(planner));
  nearest_->setDistanceFunction(
      [](const Node* a, const Node* b) { return (a->tip - b->tip).norm(); });
}

void SlidingConnect::Tree::clear() {
  if (nearest_) nearest_->clear();
  for (const auto& node : nodes_) space_->freeState(node->state);
  nodes_.clear();
}

SlidingConnect::Node* SlidingConnect::Tree::nearest(const Vec3& tip) const {
  Node query{tip};
  return nearest_->nearest(&query);
}

SlidingConnect::Node* SlidingConnect::Tree::add(const Vec3& tip, const Node* parent) {
  nodes_.push_back(std::make_unique<Node>(Node{tip, parent, space_->allocState()}));
  put(tip, nodes_.back()->state);
  nearest_->add(nodes_.back().get());
  return nodes_.back().get();
}

const SlidingConnect::Node* SlidingConnect::Tree::add_way(const Node* from,
                                                          std::span<const Vec3> way) {
  for (const Vec3& tip : way.subspan(1)) from = add(tip, from);
  return from;
}

SlidingConnect::SlidingConnect(const base::SpaceInformationPtr& space,
                               std::shared_ptr<GuardPool> guards, const SteerOptions& options)
    : Planner(space, "SlidingConnect"),
      guards_(std::move(guards)),
      options_(options),
      start_(space),
      goal_(space) {
  specs_.recognizedGoal = base::GOAL_SAMPLEABLE_REGION;
  ProjectingSteer(*guards_->borrow(), options_);  // what is wrong with the options is thrown here
  declareParam<double>("range", this, &SlidingConnect::setRange, &SlidingConnect::getRange,
                       "0.:1.:10000.");
  addPlannerProgressProperty("steering time REAL", [this] { return std::to_string(steering_); });
  addPlannerProgressProperty("ways INTEGER", [this] { return std::to_string(ways_); });
}

void SlidingConnect::setup() {
  Planner::setup();
  require_tip_space(si_, guards_);
  start_.set_up(this);
  goal_.set_up(this);
}

void SlidingConnect::clear() {
  Planner::clear();
  sampler_.reset();
  steering_ = 0.0;
  ways_ = 0;
  start_.clear();
  goal_.clear();
}

bool SlidingConnect::grow(const Steer& steer, Tree& tree, Tree& other, const Vec3& towards,
                          const Node*& end, const Node*& end_of_other) const {
  const double range =
      range_ > 0.0 ? range_ : range_of_extent * si_->getStateSpace()->getMaximumExtent();
  const Node* const near = tree.nearest(towards);
  const ProjectingSteer::Way way = steer(near->tip, towards, range);
  if (way.points.size() < 2) return false;
  end = tree.add_way(near, way.points);
  const Node* const near_in_other = other.nearest(end->tip);
  const ProjectingSteer::Way back =
      steer(near_in_other->tip, end->tip, std::numeric_limits<double>::infinity());
  end_of_other = other.add_way(near_in_other, back.points);
  return back.ending == ProjectingSteer::Ending::arrived;
}

void SlidingConnect::add_solution(const Node* from_start, const Node* from_goal) {
  std::vector<Vec3> tips;
  for (const Node* node = from_start; node != nullptr; node = node->parent) {
    tips.push_back(node->tip);
  }
  std::reverse(tips.begin(), tips.end());
  // Both ends are the same place.
  for (const Node* node = from_goal->parent; node != nullptr; node = node->parent) {
    tips.push_back(node->tip);
  }
  const auto path = std::make_shared<ompl::geometric::PathGeometric>(si_);
  base::State* const state = si_->allocState();
  for (const Vec3& tip : tips) {
    put(tip, state);
    path->append(state);
  }
  si_->freeState(state);
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
    if (keeps_margin(*guard, tip_of(state))) start_.add_root(tip_of(state));
  }
  if (start_.empty()) return base::PlannerStatus::INVALID_START;
  if (!region->couldSample()) return base::PlannerStatus::INVALID_GOAL;
  if (!sampler_) sampler_ = si_->allocStateSampler();

  base::State* const sample = si_->allocState();
  base::PlannerStatus status = base::PlannerStatus::TIMEOUT;
  for (std::size_t iteration = 0; !stop; ++iteration) {
    if (goal_.empty() || pis_.getSampledGoalsCount() < goal_.size() / 2) {
      const base::State* state = goal_.empty() ? pis_.nextGoal(stop) : pis_.nextGoal();
      if (state != nullptr && keeps_margin(*guard, tip_of(state))) goal_.add_root(tip_of(state));
      if (goal_.empty()) {
        status = base::PlannerStatus::INVALID_GOAL;
        if (state == nullptr) break;
        continue;
      }
      status = base::PlannerStatus::TIMEOUT;
    }
    sampler_->sampleUniform(sample);
    const Node* from_start = nullptr;
    const Node* from_goal = nullptr;
    const bool has_met = iteration % 2 == 0
                             ? grow(steer, start_, goal_, tip_of(sample), from_start, from_goal)
                             : grow(steer, goal_, start_, tip_of(sample), from_goal, from_start);
    if (has_met) {
      add_solution(from_start, from_goal);
      status = base::PlannerStatus::EXACT_SOLUTION;
      break;
    }
  }
  si_->freeState(sample);
  return status;
}

void SlidingConnect::getPlannerData(base::PlannerData& data) const {
  Planner::getPlannerData(data);
  using Vertex = base::PlannerDataVertex;
  for (const Tree* tree : {&start_, &goal_}) {
    for (const auto& node : tree->nodes()) {
      const Node* const parent = node->parent;
      if (parent != nullptr) {
        // From the start towards the goal.
        const bool is_forward = tree == &start_;
        data.addEdge(Vertex(is_forward ? parent->state : node->state),
                     Vertex(is_forward ? node->state : parent->state));
      } else if (tree == &start_) {
        data.addStartVertex(Vertex(node->state));
      } else {
        data.addGoalVertex(Vertex(node->state));
      }
    }
  }
}

}  // namespace

std::shared_ptr<base::Planner> make_sliding_connect(
    const std::shared_ptr<base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards,
    const SteerOptions& options) {
  require_tip_space(space, guards);
  return std::make_shared<SlidingConnect>(space, std::move(guards), options);
}

}  // namespace keepout
