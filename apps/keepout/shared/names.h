// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace keepout::app {

// Names that a user may type, and messages about them.

/// Returns "; did you mean 'certified'?", to append to an error message; empty if no name is
/// similar.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);

/// Returns "a, b, c".
std::string enumerated(const std::vector<std::string>& names, std::string_view between = ", ");

/// Returns "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& names);

/// Returns the beginning of untrusted text: at most 200 bytes, "..." if there are more. Replaces
/// bytes other than printable ASCII by '?'.
std::string printable(std::string_view text);

/// Returns printable(text) in quotes.
std::string in_quotes(std::string_view text);

/// Returns the word quoted for a shell.
std::string shell_word(const std::string& word);

/// Returns the names in a table of parts.
template <class Table>
std::vector<std::string> names(const Table& table) {
  std::vector<std::string> all;
  for (const auto& entry : table) all.emplace_back(entry.name);
  return all;
}

/// Returns a table of parts as text: the title, and one line for each part.
template <class Table>
std::string listing(std::string_view title, const Table& table) {
  constexpr std::size_t name_width = 18;
  std::string text = std::string(title) + ":\n";
  for (const auto& entry : table) {
    std::string name(entry.name);
    name.resize(std::max<std::size_t>(name.size() + 1, name_width), ' ');
    text += "  " + name + std::string(entry.description) + "\n";
  }
  return text;
}

}  // namespace keepout::app
