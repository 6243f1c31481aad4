// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ompl/base/MotionValidator.h>
#include <ompl/base/Planner.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateValidityChecker.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "plan/plan.h"
#include "plan/problems.h"

namespace keepout::app {

// A planner of OMPL that is run and timed in a RealVectorStateSpace, be it of tips or of joints.

/// Time spent in checking. What is checked on the way of a check is part of it.
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

/// Gives the space a checker and a validator, timed; no validator stands for OMPL's own, which
/// samples. The timer must outlive the space.
void set_timed_checkers(const ompl::base::SpaceInformationPtr& space,
                        const ompl::base::StateValidityCheckerPtr& states,
                        ompl::base::MotionValidatorPtr motions, CheckTimer& timer);

/// All generators that OMPL makes from here on have their seeds from this one. It is the process's:
/// not for two threads at once.
void set_planning_seed(std::uint64_t seed);

/// One of ompl_planners. `range`: the longest motion that it adds, where it has such a thing; 0:
/// its own. Throws Error for another name.
ompl::base::PlannerPtr named_planner(const std::string& name,
                                     const ompl::base::SpaceInformationPtr& space, double range);

struct SolvedPath {
  Path states = {};      // empty unless solved
  double seconds = 0.0;  // of the planner, and of the simplifier
};

/// Has a planner look for its first path, and simplifies it if the options say so.
SolvedPath solve(const ompl::base::PlannerPtr& planner, const PlanningProblem& problem,
                 const PlanOptions& options, const std::function<bool()>& interrupted);

}  // namespace keepout::app
