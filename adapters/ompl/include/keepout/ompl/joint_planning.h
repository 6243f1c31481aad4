// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/ompl/guard_pool.h"

// Of the Open Motion Planning Library, by name only: who plans includes its headers.
namespace ompl::base {
class MotionValidator;
class SpaceInformation;
class StateSpace;
class StateValidityChecker;
}  // namespace ompl::base

namespace keepout {

// All of these plan for a whole instrument, in the space of its joints: a RealVectorStateSpace with
// one dimension for each joint, in the order of the chain [rad or length], whose bounds are within
// the joints' limits. A motion between two states is the one on which all joints go straight on,
// q + s (q' - q), s in [0, 1]. They throw Error, which says what to do, for any other space. What
// they return holds on to the pool, and may be called from any thread.

/// A RealVectorStateSpace whose bounds are the joints' limits, and in which states are as far apart
/// as the joints' motions are long: a radian counts as much as it moves a point of a body, at the
/// most, among the configurations with each joint at either limit or halfway. In lengths, so that a
/// planner's range is one, and `the longest valid segment` of sampled checking too. Throws Error
/// for a joint without limits.
std::shared_ptr<ompl::base::StateSpace> make_joint_space(const Instrument& instrument);

/// Says of a configuration whether it may be stood in: within the space's bounds, and each body
/// keeps the margin less the band (InstrumentConstraint::prove), on the free side of the mesh where
/// the guards ask about sides.
std::shared_ptr<ompl::base::StateValidityChecker> make_state_validity_checker(
    const std::shared_ptr<ompl::base::SpaceInformation>& space,
    std::shared_ptr<InstrumentPool> guards);

/// Says of a motion whether it is valid: only if all of it is proven (MotionProof::is_clear), for
/// each body, on the motion that the joints really make, and it ends within the space's bounds. The
/// last valid state of one that is not is one up to which it is proven; of one that leaves the
/// bounds, its start. The space's longest valid segment has no part in it.
std::shared_ptr<ompl::base::MotionValidator> make_motion_validator(
    const std::shared_ptr<ompl::base::SpaceInformation>& space,
    std::shared_ptr<InstrumentPool> guards);

/// Gives the space both of the above.
void set_certified_checkers(const std::shared_ptr<ompl::base::SpaceInformation>& space,
                            const std::shared_ptr<InstrumentPool>& guards);

}  // namespace keepout
