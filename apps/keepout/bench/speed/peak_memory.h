// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace keepout::app {

/// The most memory that the process has held at once since the last reset. [bytes] 0 where the
/// system does not tell.
std::size_t peak_memory();

/// Begins anew. Where the system refuses, the peak is that since the process began.
void reset_peak_memory();

}  // namespace keepout::app
