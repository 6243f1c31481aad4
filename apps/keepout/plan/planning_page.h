// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <vector>

#include "plan/planning_result.h"

namespace keepout::app {

/// Writes a page that needs nothing but itself: the table, and for each mesh and checker a picture
/// of all paths, with what comes too near the mesh or enters it in the colour of alarm.
void write_planning_page(std::ostream& out, const PlanOptions& options,
                         const std::vector<PlanningScene>& scenes,
                         const std::vector<PlanningRun>& runs);

}  // namespace keepout::app
