// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "commands.h"

namespace keepout::app {

/// Drives the instrument of options.robot over the meshes in each mode (guarded_stroke.h), and
/// judges each cycle; writes a record of the kind simulate_robot (docs/records.md) and its report,
/// and prints a table. A StopSignal ends it early, and what is done is printed and written. The
/// exit status: failure when a cycle that was certified broke what docs/joint-space-step.md
/// promises. Throws Error.
int simulate_robot(const SimulateOptions& options, std::ostream& out);

}  // namespace keepout::app
