// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

namespace keepout::app {

struct TableCell {
  enum class Look {
    number,
    name,   // to the left
    words,  // the same, and broken into lines
    bad     // a number that ought to be nothing
  };
  std::string text;  // plain; escaped when printed
  Look look = Look::number;
};

/// A table of figures. The first cell of a row is its name, and stays in sight.
struct Table {
  enum class Height {
    all_rows,
    windowed  // scrolls within a part of the screen, its head in sight; printed in full
  };
  std::vector<std::string> columns;
  std::vector<std::vector<TableCell>> rows;
  Height height = Height::all_rows;
};

void print_table(std::ostream& out, const Table& table);

/// A count that ought to be 0.
TableCell harm(std::size_t count);

}  // namespace keepout::app
