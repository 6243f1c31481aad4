// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "shared/columns.h"

namespace keepout::app {

/// A page of what a record says in words and rows, for where there is no front end that could draw:
/// see report_page.h. Series of numbers, such as the cycles of a stroke, are left to the JSON.
void print_plain_page(std::ostream& out, const Json& record);

}  // namespace keepout::app
