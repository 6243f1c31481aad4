// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "shared/columns.h"

namespace keepout::app {

/// Prints a text, or each of a list, in lines that fit a terminal.
void print_wrapped(std::ostream& out, const Json& text);

}  // namespace keepout::app
