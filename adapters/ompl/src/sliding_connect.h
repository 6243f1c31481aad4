// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ompl/base/Planner.h>
#include <ompl/datastructures/NearestNeighbors.h>

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "keepout/ompl/guard_pool.h"
#include "keepout/ompl/projecting_steer.h"

namespace keepout {

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

}  // namespace keepout
