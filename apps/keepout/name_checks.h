// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace keepout::app {

/// What an option may be told whose value is a name: with a hint at the one that was meant, and a
/// list of all.
CLI::Validator one_of(std::vector<std::string> names);

/// The same, for transform(): names of the values of an enumeration.
template <class Enum>
CLI::Validator one_of(const std::vector<std::pair<std::string, Enum>>& values) {
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  const CLI::Validator check = one_of(names);
  const auto replace = [values, check](std::string& text) {
    std::string problem = check(text);
    for (const auto& [name, value] : values) {
      if (problem.empty() && text == name) {
        text = std::to_string(static_cast<std::underlying_type_t<Enum>>(value));
        break;
      }
    }
    return problem;
  };
  return {replace, check.get_description()};
}

}  // namespace keepout::app
