// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>

#include "columns.h"

namespace keepout::app {

/// Whether there is what makes a report more than a plain page: see page_template.h.
bool has_report_template();

/// Writes the report of a record as one HTML page that needs nothing but itself. Where its front
/// end is missing, the page is a plain one of tables, and the text says what is missing; else it is
/// empty.
std::string print_report(std::ostream& out, const Json& record);

}  // namespace keepout::app
