// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>

#include "bench/speed/speed_record.h"

namespace keepout::app {

/// "at least 38x", "at most 45 bytes".
std::string demand_text(const SpeedRow& row);

/// "41.2x"; "-" where nothing was measured.
std::string figure_text(const SpeedRow& row);

/// "met", "short" or "not measured".
std::string verdict_text(const SpeedRow& row);

/// "5.13 / 7.90 / 12.1 us": median, p99 and p99.9, as far as there are enough samples.
std::string side_text(const MeasuredSide& side);

/// For a terminal, line by line as the rows come in.
void print_head(std::ostream& out, const SpeedRecord& record);
void print_row(std::ostream& out, const SpeedRow& row);

/// What every index takes for a query, and which rows fall short.
void print_queries(std::ostream& out, const SpeedRecord& record);
void print_summary(std::ostream& out, const SpeedRecord& record);

/// All of it as JSON: {"machine": {...}, "rows": [{"work": ..., "compared": ..., "demanded":
/// {"at_least": 38}, "figure": 41.2, "unit": "x", "met": true, "sides": [...]}, ...], "queries":
/// [...], "histogram": {"steps": {"bins": [[from_ns, count], ...], ...}, "nothing": {...}}}. null
/// stands for what was not measured.
void write_json(std::ostream& out, const SpeedRecord& record);

}  // namespace keepout::app
