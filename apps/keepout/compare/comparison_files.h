// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "compare/comparison.h"

namespace keepout::app {

/// Tables for a terminal, and the verdict. Parts that were not compared are left out.
void print(std::ostream& out, const Comparison& comparison);

/// All of it, the verdict included.
void write_json(std::ostream& out, const ComparisonRecord& record);

}  // namespace keepout::app
