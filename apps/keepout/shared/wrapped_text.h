// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>

namespace keepout::app {

/// Prints a text in lines that fit a terminal.
void print_wrapped(std::ostream& out, const std::string& text);

}  // namespace keepout::app
