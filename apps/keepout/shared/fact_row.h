// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iomanip>
#include <ostream>
#include <string>
#include <string_view>

namespace keepout::app {

/// Prints a fact as a line for a terminal: its name, and its value in a column.
inline void print_row(std::ostream& out, std::string_view name, const std::string& value) {
  out << "  " << std::left << std::setw(14) << name << value << '\n';
}

}  // namespace keepout::app
