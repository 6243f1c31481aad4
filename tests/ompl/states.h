// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <ompl/base/Planner.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>

#include <algorithm>
#include <thread>
#include <vector>

#include "keepout/fixtures/random.h"

namespace keepout {

// Shared by the tests of planning for a tip and for an instrument. All spaces are
// RealVectorStateSpaces.

namespace base = ompl::base;
using Coordinates = std::vector<double>;

inline double* values_of(const base::State* state) {
  return const_cast<base::State*>(state)->as<base::RealVectorStateSpace::StateType>()->values;
}

/// A state that goes away with this object.
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

/// Has a planner look for a path; empty if it finds none.
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

/// Expects that no part of the motion is valid.
inline void expect_invalid_from_the_start(const base::MotionValidator& validator,
                                          const base::SpaceInformationPtr& space, const State& from,
                                          const State& to) {
  const State last(space, Coordinates(space->getStateDimension(), 9.0));
  std::pair<base::State*, double> last_valid{last.get(), -1.0};
  EXPECT_FALSE(validator.checkMotion(from.get(), to.get(), last_valid));
  EXPECT_EQ(last_valid.second, 0.0);
  EXPECT_EQ(last.values(), from.values());
}

/// Asks from many threads about the same motions. The answers must be the same.
template <class AnyPlace>
std::vector<bool> answers_of_threads(const base::MotionValidator& validator,
                                     const base::SpaceInformationPtr& space, std::size_t count,
                                     const AnyPlace& any_place) {
  constexpr int motions = 200;
  std::vector<std::vector<bool>> results(count);
  std::vector<std::thread> threads;
  for (auto& result : results) {
    threads.emplace_back([&] {
      Random random(3);
      for (int i = 0; i < motions; ++i) {
        const State a(space, any_place(random)), b(space, any_place(random));
        result.push_back(validator.checkMotion(a.get(), b.get()));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : results) EXPECT_EQ(result, results.front());
  EXPECT_EQ(validator.getCheckedMotionCount(), motions * count);
  return results.front();
}

}  // namespace keepout
