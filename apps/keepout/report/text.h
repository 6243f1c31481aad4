// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace keepout::app {

/// Any text as the content, or as a quoted attribute, of an HTML or XML element.
std::string escape(std::string_view text);

/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& names);

}  // namespace keepout::app
