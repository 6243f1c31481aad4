// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace keepout::app {

/// "; did you mean 'certified'?", to go on with after an error; empty where there is no such name.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);

/// "a, b, c".
std::string enumerated(const std::vector<std::string>& names);

}  // namespace keepout::app
