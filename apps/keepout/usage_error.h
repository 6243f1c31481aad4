// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace keepout::app {

/// What is wrong with a command line, in words that name the option and its value, with a hint at
/// what was meant and at the help. `error`: what app.parse() threw, and no call for help.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace keepout::app
