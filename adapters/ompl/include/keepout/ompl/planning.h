// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/ompl/guard_pool.h"
#include "keepout/ompl/projecting_steer.h"

// Forward declarations of the Open Motion Planning Library: callers include its headers.
namespace ompl::base {
class MotionValidator;
class Planner;
class SpaceInformation;
class StateValidityChecker;
}  // namespace ompl::base

namespace keepout {

// The functions below plan for a tip. The state space is a RealVectorStateSpace of three dimensions
// with bounds, in the frame and the unit of the mesh. The functions throw Error, with a remedy, for
// any other space. The returned objects share the pool, and may be called from any thread.

/// Returns a checker of states. A state is valid if it is within the space's bounds and maintains
/// the required clearance: see keeps_margin().
std::shared_ptr<ompl::base::StateValidityChecker> make_state_validity_checker(
    const std::shared_ptr<ompl::base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards);

/// Returns a validator of straight motions. A motion is valid only if the certified rule proves the
/// whole motion (see proves()), and its end is within the space's bounds. The last valid state of
/// an invalid motion is the end of the proved part, or the start if the motion leaves the bounds.
/// Ignores the space's longest valid segment.
std::shared_ptr<ompl::base::MotionValidator> make_motion_validator(
    const std::shared_ptr<ompl::base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards);

/// Sets the checker and the validator above in the space.
void set_certified_checkers(const std::shared_ptr<ompl::base::SpaceInformation>& space,
                            const std::shared_ptr<GuardPool>& guards);

/// Returns a planner that grows two trees like RRT-Connect, but with ProjectingSteer. If a straight
/// motion is invalid, it slides along the anatomy. So its whole path consists of proved steps. OMPL
/// parameter: `range`, the longest path towards a sample (0: a fifth of the space's extent). Make
/// one planner for each thread.
///
/// Source of the two trees: Kuffner and LaValle, "RRT-Connect: an efficient approach to
/// single-query path planning", ICRA 2000.
std::shared_ptr<ompl::base::Planner> make_sliding_connect(
    const std::shared_ptr<ompl::base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards,
    const SteerOptions& options = {});

}  // namespace keepout
