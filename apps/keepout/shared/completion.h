// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <span>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace keepout::app {

/// Prints the completions of the last of `words`, one a line: commands, options of the command, or
/// the names that the current option or argument accepts. For a mesh, prints the names of sample
/// meshes and an empty line, because files are accepted as well. Prints nothing if only a file name
/// is expected. `words`: as bash splits a command line, with "=" as a word.
void print_completions(const CLI::App& app, std::span<const std::string> words, std::ostream& out);

}  // namespace keepout::app
