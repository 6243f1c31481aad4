// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>

#include "simulation_record.h"

namespace keepout::app {

/// Writes the report as one HTML page that needs nothing but itself. The page appears whole or not
/// at all: an older one is replaced in the last moment. Throws Error when it cannot be written, and
/// when there is no mesh, no run, or a stroke without a cycle, or when runs differ in their
/// strokes.
void write_report(const std::filesystem::path& path, const Simulation& simulation);

/// The page itself. Throws as above.
void print_report(std::ostream& out, const Simulation& simulation);

}  // namespace keepout::app
