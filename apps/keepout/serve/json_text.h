// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace keepout::app {

// JSON as text, appended to a string that keeps its memory.

/// The shortest digits that read back as the same double; "-0.0" for a negative zero, so that no
/// reader takes it for an integer; null for what is not finite.
void append_number(std::string& text, double value);

void append_count(std::string& text, std::size_t value);

/// A string in quotes. `value`: UTF-8.
void append_string(std::string& text, std::string_view value);

/// Somebody else's text for a message: its beginning, other bytes than printable ASCII as '?'.
void append_printable(std::string& text, std::string_view value);

/// The same in single quotes.
void append_quoted(std::string& text, std::string_view value);

}  // namespace keepout::app
