// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace keepout::app {

/// Any text as the content, or as a quoted attribute, of an HTML or XML element.
std::string escape(std::string_view text);

/// A count with its thousands set apart: 24,000.
std::string grouped(std::size_t count);

/// "1 stroke", "2 strokes".
std::string counted(std::size_t count, std::string_view noun);

/// Three significant digits, never an exponent: 1230, 12.3, 0.00123.
std::string rounded(double value);

/// A length in the unit that suits it, mm, um or nm, joined by a space that does not break.
std::string length_text(double mm);

/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& names);

}  // namespace keepout::app
