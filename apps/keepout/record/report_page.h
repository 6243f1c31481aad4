// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>

#include "shared/columns.h"

namespace keepout::app {

/// Returns why the report of a record can only be a plain page, as text; empty if it can be
/// complete. null stands for all kinds of records. See page_template.h.
std::string missing_template(const Json& record = nullptr);

/// Writes the report of a record as one self-contained HTML page. Throws Error if its template is
/// missing.
void print_report(std::ostream& out, const Json& record);

}  // namespace keepout::app
