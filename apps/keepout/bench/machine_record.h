// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/benchmark.h"

namespace keepout::app {

/// The machine that this runs on, how keepout was built, and the libraries in it.
Machine this_machine();

}  // namespace keepout::app
