// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "shared/program.h"
#include "simulate/simulate.h"

namespace keepout::app {

/// Returns the commands of `keepout`. `simulate` has the option --bench if `time_parts` is set.
std::vector<Command> user_commands(TimeParts time_parts = {});

}  // namespace keepout::app
