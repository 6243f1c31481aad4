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

/// Prints what the last of `words` may be completed to, one a line: commands, options of the
/// command that the words before it name, or names that are values of the option before it or of
/// the argument in its place. Where a mesh is expected, prints names of fixtures, and an empty
/// line: files are as welcome. Prints nothing where only the user's files come into question.
/// `words`: as bash cuts a command line, "=" a word.
void print_completions(const CLI::App& app, std::span<const std::string> words, std::ostream& out);

}  // namespace keepout::app
