// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shared/columns.h"
#include "simulate/simulation.h"

namespace keepout::app {

/// The record of a simulation: see docs/records.md; benchmark and comparison are null. Throws Error
/// when there is no mesh, no run, or a stroke without a cycle, or when runs differ in their
/// strokes.
Json record_of(const Simulation& simulation);

}  // namespace keepout::app
