// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rule.h"
#include "sweep.h"

namespace keepout::peers {

/// Returns the rule that games make of a collision library: move until contact, remove the part of
/// the rest that goes into the surface, and continue, at most four times. Bullet's character
/// controller slides like this (btKinematicCharacterController::stepForwardAndStrafe). The motion
/// ends if it would turn against the desired motion, also as there. The straight
/// motion to the end of each turn is swept as well, because a tip does not move around the turn.
/// With a corridor, the desired motion is first projected into it, and so is each rest.
std::unique_ptr<Rule> slide(const Task& task, std::shared_ptr<const Sweep> sweep);

}  // namespace keepout::peers
