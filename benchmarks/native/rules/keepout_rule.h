// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rule.h"

namespace keepout::peers {

/// Returns a MotionConstraint with an activation rule, and with the corridor as a guide. Its step
/// is zero if keepout rejects the motion. Throws Error for an unknown rule.
std::unique_ptr<Rule> keepout_rule(const Task& task, const std::string& activation);

}  // namespace keepout::peers
