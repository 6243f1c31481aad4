// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "record/record.h"
#include "verify/robot/campaign.h"

namespace keepout::app {

/// The record of a campaign with an instrument, of the kind verify_robot: see docs/records.md.
Json result_of(const RobotCampaign& campaign, const std::string& command, const std::string& index,
               const std::vector<RobotTally>& tallies, std::size_t meshes);

/// Returns how many cycles broke the theorem, left a guide, or broke a joint's limits.
std::uint64_t robot_breaches(const Json& record);

/// The rows of such a record, and what they say.
void print_robot_result(std::ostream& out, const Json& record);

}  // namespace keepout::app
