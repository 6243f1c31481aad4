// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace keepout::app {

/// As a shell needs it to be one word.
std::string shell_word(const std::string& word);

}  // namespace keepout::app
