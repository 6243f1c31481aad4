// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "bench/benchmark.h"

namespace keepout::app {

/// All of it: {"machine": {...}, "rows": [{"mesh": ..., "query_us": {"p50": ..., ...}, ...}, ...]}.
/// null stands for what was not measured; a radius of null is as far as the motions lead.
void write_json(std::ostream& out, const Benchmark& benchmark);

/// The rows, one a line, below a line of names; what was not measured is empty. Each says where it
/// was measured, so that files can be put together.
void write_csv(std::ostream& out, const Benchmark& benchmark);

}  // namespace keepout::app
