// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "shared/columns.h"

namespace keepout::app {

/// The rows of a record as a table: a column for each member, those of objects within under both
/// names, "step_us_p50". Arrays are left out.
struct FlatRows {
  std::vector<std::string> columns;
  std::vector<std::vector<Json>> rows;  // as many cells as there are columns; null: it has none
};
FlatRows flat(const Json& rows);

/// As CSV, below a line of names: numbers with all their digits, text in quotes where it has to be;
/// what there is none of is empty.
void print_csv(std::ostream& out, const FlatRows& table);

}  // namespace keepout::app
