// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "name_checks.h"

#include <algorithm>

#include "suggestion.h"

namespace keepout::app {

CLI::Validator one_of(std::vector<std::string> names) {
  std::string description = '{' + enumerated(names) + '}';
  const auto check = [names = std::move(names)](std::string& text) -> std::string {
    if (std::find(names.begin(), names.end(), text) != names.end()) return {};
    const std::string hint = did_you_mean(text, names);
    return "there is no '" + text + "'" + (hint.empty() ? "; there are: " : hint + " There are: ") +
           enumerated(names);
  };
  return {check, std::move(description)};
}

}  // namespace keepout::app
