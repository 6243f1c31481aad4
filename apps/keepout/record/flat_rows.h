// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "shared/columns.h"

namespace keepout::app {

/// The rows of a record as a table, with a column for each member. A member of a nested object gets
/// both names, "step_us_p50". Arrays are omitted.
struct FlatRows {
  std::vector<std::string> columns;
  std::vector<std::vector<Json>> rows;  // one cell for each column; null: the row does not have it
};
FlatRows flat(const Json& rows);

/// Prints a table as CSV, with a header: numbers with all digits, text in quotes if necessary, and
/// empty cells for null.
void print_csv(std::ostream& out, const FlatRows& table);

}  // namespace keepout::app
