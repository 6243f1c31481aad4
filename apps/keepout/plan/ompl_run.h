// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ompl/base/MotionValidator.h>
#include <ompl/base/Planner.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateValidityChecker.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

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
                        std::function<bool(const ompl::base::State*)> is_valid,
                        ompl::base::MotionValidatorPtr validator, CheckTimer& timer);

/// All generators that OMPL makes from here on have their seeds from this one. It is the process's:
/// not for two threads at once.
void set_planning_seed(std::uint64_t seed);

/// One of ompl_planners. `range`: the longest motion that it adds, where it has such a thing; 0:
/// its own. Throws Error for another name.
ompl::base::PlannerPtr named_planner(const std::string& name,
                                     const ompl::base::SpaceInformationPtr& space, double range);

/// How a planner shall be run.
struct SolveOptions {
  double seconds = 5.0;
  bool simplify = false;  // shorten the path by OMPL's simplifier, under the same checker
};

struct SolvedPath {
  bool solved = false;
  double seconds = 0.0;                          // of the planner, and of the simplifier
  std::vector<std::vector<double>> states = {};  // empty unless solved
};

/// Has a planner look for its first path from start to goal.
SolvedPath solve(const ompl::base::PlannerPtr& planner, std::span<const double> start,
                 std::span<const double> goal, const SolveOptions& options,
                 const std::function<bool()>& interrupted);

}  // namespace keepout::app
