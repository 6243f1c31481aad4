// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "shared/columns.h"

namespace keepout::app {

/// Prints a page with the texts and rows of a record, without pictures, for use without page
/// templates: see report_page.h. Series of numbers, such as the cycles of a stroke, are only in the
/// JSON.
void print_plain_page(std::ostream& out, const Json& record);

}  // namespace keepout::app
