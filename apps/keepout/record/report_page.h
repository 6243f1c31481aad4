// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>

#include "shared/columns.h"

namespace keepout::app {

/// What is missing to make the report of a record, or of any where there is none yet, more than a
/// plain page: in words, empty where there is all. See page_template.h.
std::string missing_template(const Json& record = nullptr);

/// Writes the report of a record as one HTML page that needs nothing but itself. Throws Error where
/// something is missing.
void print_report(std::ostream& out, const Json& record);

}  // namespace keepout::app
