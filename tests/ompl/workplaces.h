// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <ompl/base/Planner.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/robots.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/ompl/joint_planning.h"
#include "keepout/ompl/planning.h"
#include "keepout/oracle/instrument_oracle.h"
#include "keepout/oracle/safety_oracle.h"
#include "meshes.h"
#include "messages.h"
#include "trials.h"

namespace keepout {

// Shared by the planning tests for tips and for instruments. All spaces are RealVectorStateSpaces.

namespace base = ompl::base;
using Coordinates = std::vector<double>;

inline double* values_of(const base::State* state) {
  return const_cast<base::State*>(state)->as<base::RealVectorStateSpace::StateType>()->values;
}

/// Owns a state of a space.
class State {
 public:
  template <class Values = std::initializer_list<double>>
  State(const base::SpaceInformationPtr& space, const Values& values)
      : space_(space), state_(space->allocState()) {
    std::copy(std::begin(values), std::end(values), values_of(state_));
  }
  ~State() { space_->freeState(state_); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  base::State* get() const { return state_; }
  Coordinates values() const {
    return {values_of(state_), values_of(state_) + space_->getStateDimension()};
  }

 private:
  base::SpaceInformationPtr space_;
  base::State* state_;
};

/// Returns the path that a planner finds within `seconds`; empty if it fails.
inline std::vector<Coordinates> solved(base::Planner& planner, const State& start,
                                       const State& goal, double seconds) {
  const base::SpaceInformationPtr& space = planner.getSpaceInformation();
  const auto definition = std::make_shared<base::ProblemDefinition>(space);
  definition->addStartState(start.get());
  definition->setGoalState(goal.get());
  planner.setProblemDefinition(definition);
  planner.setup();
  planner.solve(seconds);
  std::vector<Coordinates> path;
  if (!definition->hasExactSolution()) return path;
  for (const base::State* state :
       definition->getSolutionPath()->as<ompl::geometric::PathGeometric>()->getStates()) {
    path.emplace_back(values_of(state), values_of(state) + space->getStateDimension());
  }
  return path;
}

/// A mesh, a pool of at most two guards that prove motions past it, and the space of the motions.
template <class Pool>
struct Workplace {
  explicit Workplace(std::shared_ptr<const Mesh> of) : mesh(std::move(of)) {
    ompl::msg::noOutputHandler();
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  void certify() {
    set_certified_checkers(space, guards);
    space->setup();
  }
  base::MotionValidatorPtr validator() const { return make_motion_validator(space, guards); }
  bool is_valid(const Coordinates& values) const {
    return make_state_validity_checker(space, guards)->isValid(State(space, values).get());
  }

  /// Returns the error that rejects another space.
  std::string refusal(const base::StateSpacePtr& other) const {
    return error_of(
        [&] { make_motion_validator(std::make_shared<base::SpaceInformation>(other), guards); });
  }

  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<WideBvh> index = std::make_shared<WideBvh>(mesh);
  std::shared_ptr<Pool> guards;
  base::SpaceInformationPtr space;
};

/// The planning problem of a tip beside a shape.
struct TipPlace : Workplace<GuardPool> {
  static constexpr double kept = 0.5;
  static constexpr double tolerance = 1e-6;  // far above 3 tau of shapes of this size
  static constexpr std::array shapes{"cube",   "sphere",     "gear",   "thin_plates",
                                     "cortex", "star_bumps", "tunnel", "triangle_soup"};
  static constexpr std::uint64_t seed = 7;
  static int motions() { return 800; }
  static int least_of_each() { return 25; }

  explicit TipPlace(const std::shared_ptr<const Mesh>& of, Inside sides = Inside::escape)
      : Workplace(of), inside(sides), oracle_(of) {
    guards = std::make_shared<GuardPool>([this] { return make(); }, 2);
    auto states = std::make_shared<base::RealVectorStateSpace>(3);
    base::RealVectorBounds bounds(3);
    for (unsigned int i = 0; i < 3; ++i) {
      bounds.setLow(i, mesh->bounds().low[i] - 10.0);
      bounds.setHigh(i, mesh->bounds().high[i] + 10.0);
    }
    states->setBounds(bounds);
    space = std::make_shared<base::SpaceInformation>(states);
  }
  MotionConstraint make() const {
    return make_motion_constraint(mesh, index, {.options = {.margin = kept}, .inside = inside});
  }

  Coordinates any_state(Random& random) const {
    Coordinates place;
    for (int i = 0; i < 3; ++i) {
      place.push_back(random.uniform(mesh->bounds().low[i] - 9.0, mesh->bounds().high[i] + 9.0));
    }
    return place;
  }

  /// Returns the end of a short motion, or of a long one of many pieces.
  Coordinates any_end(int i, const Coordinates& from, Random& random) const {
    if (i % 2 == 0) return any_state(random);
    const Vec3 to = Vec3(from.data()) + Vec3(random.uniform(0.0, 8.0) * random.direction());
    return {to.begin(), to.end()};
  }

  /// Returns true if the oracle finds any point of the motion nearer to the mesh than `than`.
  bool comes_nearer(const Coordinates& from, const Coordinates& to,
                    double than = kept - tolerance) {
    return oracle_.check(Vec3(from.data()), Vec3(to.data()), than).below;
  }

  /// Fails unless the oracle finds the motion too close, at most 0.05 beyond the last valid state.
  void expect_a_reason(const Coordinates& from, const Coordinates& to, const Coordinates& last) {
    if (!space->satisfiesBounds(State(space, to).get())) return;
    EXPECT_TRUE(comes_nearer(from, to, kept + tolerance)) << "rejected without a reason";
    const Vec3 a(from.data()), b(to.data());
    const Vec3 beyond = Vec3(last.data()) + (b - a).normalized() * 0.05;
    EXPECT_TRUE(comes_nearer(from, {beyond.begin(), beyond.end()}, kept + tolerance));
  }

  // Beside the cube.
  const Coordinates start{0, 0, 55}, beside{0, 0.5, 55}, farther{3, 0, 55}, out_of_bounds{0, 0, 65};
  static Guide guide() {
    return Guide::point("corridor", Region::slab({0, 0, 55}, Vec3::UnitX(), 1.0));
  }

  Inside inside;

 private:
  oracle::SafetyOracle oracle_;
};

/// The planning problem of a manipulator that hangs from a port above a shape.
struct InstrumentPlace : Workplace<InstrumentPool> {
  static constexpr double kept = 0.198;      // margin less band
  static constexpr double tolerance = 1e-8;  // far above 3 tau of an instrument of this size
  static constexpr std::array shapes{"cube", "gear", "thin_plates", "cortex", "triangle_soup"};
  static constexpr std::uint64_t seed = 11;
  static int motions() { return test::trials(2000); }
  static int least_of_each() { return motions() / 40; }

  explicit InstrumentPlace(const std::shared_ptr<const Mesh>& of)
      : Workplace(of),
        instrument(psm({{0.0, 0.0, mesh->bounds().high.z() + 60.0}, Mat3::Identity()})),
        oracle_(std::make_shared<const monitor::TriangleTree>(mesh), monitor::judged_psm(),
                instrument.chain().base()) {
    guards = std::make_shared<InstrumentPool>([this] { return make(); }, 2);
    space = std::make_shared<base::SpaceInformation>(make_joint_space(instrument));
  }
  InstrumentConstraint make() const {
    return make_instrument_constraint(mesh, index, instrument, {});
  }

  /// Returns a state above the shape or in it, with the wrist bent in any direction.
  Coordinates any_state(Random& random) const {
    return {random.uniform(-0.6, 0.6), random.uniform(-0.5, 0.5), random.uniform(20.0, 130.0),
            random.uniform(-3.0, 3.0), random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3)};
  }

  /// Returns the end of a long motion, or of a short one that ends near `from`.
  Coordinates any_end(int i, const Coordinates& from, Random& random) const {
    Coordinates to = any_state(random);
    const double share = i % 2 == 0 ? 1.0 : random.uniform(0.0, 0.2);
    for (std::size_t k = 0; k < to.size(); ++k) to[k] = from[k] + share * (to[k] - from[k]);
    return to;
  }

  /// Returns the least clearance of all bodies at `places` + 1 points of the motion; infinite above
  /// 1. [mm]
  double least(const Coordinates& from, const Coordinates& to, int places) {
    double clearance = test::infinity;
    for (int i = 0; i <= places; ++i) {
      Coordinates q = from;
      for (std::size_t k = 0; k < q.size(); ++k) q[k] += i * (to[k] - from[k]) / places;
      oracle_.move_to(q);
      clearance = std::min(clearance, oracle_.clearance(1.0));
    }
    return clearance;
  }
  bool comes_nearer(const Coordinates& from, const Coordinates& to) {
    return !(least(from, to, from == to ? 1 : 60) >= kept - tolerance);
  }
  void expect_a_reason(const Coordinates&, const Coordinates&, const Coordinates&) {}

  // Beside the cube.
  const Coordinates start{0, 0, 20, 0, 0, 0}, beside{0, 0, 20.5, 0, 0, 0},
      farther{0, 0, 24, 0, 0, 0}, out_of_bounds{0, 0, -1, 0, 0, 0};
  Guide guide() const {
    ChainState chain;
    instrument.chain().forward_kinematics(start, chain);
    return Guide::point("near", {6, Vec3::Zero()}, Region::ball(chain.link(6).position, 1.0));
  }

  Instrument instrument;

 private:
  oracle::InstrumentOracle oracle_;
};

}  // namespace keepout
