// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/ompl/guard_pool.h"

// Forward declarations of the Open Motion Planning Library: callers include its headers.
namespace ompl::base {
class MotionValidator;
class SpaceInformation;
class StateSpace;
class StateValidityChecker;
}  // namespace ompl::base

namespace keepout {

// The functions below plan for a whole instrument, in the space of its joints. The space is a
// RealVectorStateSpace with one dimension for each joint, in the order of the chain [rad or
// length]. Its bounds are within the joints' limits. The motion between two states q and q' is q +
// s (q' - q), s in [0, 1]. The functions throw Error, with a remedy, for any other space. The
// returned objects share the pool, and may be called from any thread.

/// Returns a RealVectorStateSpace with the joints' limits as its bounds and a distance in lengths.
/// The weight of a joint is the largest motion of a body's point per unit of the joint. It is
/// computed as the maximum over the configurations in which each joint is at its lower limit, at
/// its upper limit, or halfway. A planner's range is then a length. So is the longest valid segment
/// of sampled checking. Throws Error for a joint without limits.
std::shared_ptr<ompl::base::StateSpace> make_joint_space(const Instrument& instrument);

/// Returns a checker of configurations. A configuration within the space's bounds is valid if each
/// body is at least margin - band away from the meshes (InstrumentConstraint::prove). If the
/// constraints check sides, each body must also be on the free side of the mesh.
std::shared_ptr<ompl::base::StateValidityChecker> make_state_validity_checker(
    const std::shared_ptr<ompl::base::SpaceInformation>& space,
    std::shared_ptr<InstrumentPool> guards);

/// Returns a validator of motions. A motion is valid only if the whole true motion of the joints is
/// proved (MotionProof::is_clear), and it ends within the space's bounds. The last valid state of
/// an invalid motion is the end of a proved part, or the start if the motion leaves the bounds.
/// Ignores the space's longest valid segment.
std::shared_ptr<ompl::base::MotionValidator> make_motion_validator(
    const std::shared_ptr<ompl::base::SpaceInformation>& space,
    std::shared_ptr<InstrumentPool> guards);

/// Sets the checker and the validator above in the space.
void set_certified_checkers(const std::shared_ptr<ompl::base::SpaceInformation>& space,
                            const std::shared_ptr<InstrumentPool>& guards);

}  // namespace keepout
