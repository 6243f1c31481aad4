// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace keepout::app {

// Names that a user may type, and how to tell of them.

/// "; did you mean 'certified'?", to go on with after an error; empty where there is no such name.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);

/// "a, b, c".
std::string enumerated(const std::vector<std::string>& names, std::string_view between = ", ");

/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& names);

/// The beginning of somebody else's text, other bytes than printable ASCII as '?': up to 200 bytes,
/// and "..." where there are more.
std::string printable(std::string_view text);

/// The same in quotes.
std::string in_quotes(std::string_view text);

/// As a shell needs it to be one word.
std::string shell_word(const std::string& word);

/// The names in a table of parts.
template <class Table>
std::vector<std::string> names(const Table& table) {
  std::vector<std::string> all;
  for (const auto& entry : table) all.emplace_back(entry.name);
  return all;
}

/// A table of parts as text, a line each below the title.
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
