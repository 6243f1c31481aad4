// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/ompl/guard_pool.h"
#include "keepout/ompl/projecting_steer.h"

// Of the Open Motion Planning Library, by name only: who plans includes its headers.
namespace ompl::base {
class MotionValidator;
class Planner;
class SpaceInformation;
class StateValidityChecker;
}  // namespace ompl::base

namespace keepout {

// All of these plan for a tip: the state space is a RealVectorStateSpace of three dimensions, in
// the frame and the unit of the mesh, whose bounds are set. They throw Error, which says what to
// do, for any other. What they return holds on to the pool, and may be called from any thread.

/// Says of a state whether it may be stood on: within the space's bounds, and the guard keeps its
/// margin there (keeps_margin).
std::shared_ptr<ompl::base::StateValidityChecker> make_state_validity_checker(
    const std::shared_ptr<ompl::base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards);

/// Says of a straight motion between two states whether it is valid: only if the certified rule
/// proves the whole of it (proves), and its end is within the space's bounds. The last valid state
/// of one that is not is the end of what is proven; of one that leaves the bounds, its start. The
/// space's longest valid segment has no part in it.
std::shared_ptr<ompl::base::MotionValidator> make_motion_validator(
    const std::shared_ptr<ompl::base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards);

/// Gives the space both of the above.
void set_certified_checkers(const std::shared_ptr<ompl::base::SpaceInformation>& space,
                            const std::shared_ptr<GuardPool>& guards);

/// A planner that grows two trees, as RRT-Connect does, but by ProjectingSteer: where a straight
/// motion would be refused, it slides along the anatomy. So all of its path is made of proven
/// steps. Parameters, by their OMPL names: `range`, the longest way towards a sample (0: a fifth of
/// the space's extent). One planner for each thread.
///
/// Source of the two trees: Kuffner and LaValle, "RRT-Connect: an efficient approach to
/// single-query path planning", ICRA 2000.
std::shared_ptr<ompl::base::Planner> make_sliding_connect(
    const std::shared_ptr<ompl::base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards,
    const SteerOptions& options = {});

}  // namespace keepout
