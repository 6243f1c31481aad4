// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

namespace CLI {
class App;
}

namespace keepout::app {

/// Prints the manual page of a program for man: the --help texts of the program and of each
/// command.
void print_manual(const CLI::App& app, std::ostream& out);

}  // namespace keepout::app
