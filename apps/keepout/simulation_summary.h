// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "simulation_record.h"

namespace keepout::app {

/// What was simulated and what came out, in a few lines for a terminal: what the report says at
/// greater length.
void print_summary(std::ostream& out, const Simulation& simulation);

/// The figures of each run, a line each.
void print_table(std::ostream& out, const Simulation& simulation);

}  // namespace keepout::app
