// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "bench/speed/speed_record.h"

namespace keepout::app {

/// All of it as JSON: {"machine": {...}, "rows": [{"work": ..., "compared": ..., "demanded":
/// {"at_least": 38}, "figure": 41.2, "unit": "x", "met": true, "sides": [...]}, ...], "queries":
/// [...], "histogram": {"steps": {"bins": [[from_ns, count], ...], ...}, "nothing": {...}}}. null
/// stands for what was not measured.
void write_json(std::ostream& out, const SpeedRecord& record);

}  // namespace keepout::app
