// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace keepout::app {

/// The name that a mistyped word most likely means: the one that the fewest letters have to be
/// changed, added, left out or swapped with their neighbour for, upper and lower case, '-' and '_'
/// being alike. Empty where that is more than a third of them.
std::string nearest_name(std::string_view word, const std::vector<std::string>& names);

/// "; did you mean 'certified'?", to go on with after an error; empty where there is no such name.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);

/// "a, b, c".
std::string enumerated(const std::vector<std::string>& names);

}  // namespace keepout::app
