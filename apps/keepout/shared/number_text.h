// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace keepout::app {

/// Returns text formatted as by printf, at most 511 bytes.
template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 512> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

/// Returns a count with thousands separators: 24,000.
std::string grouped(std::size_t count);

/// Returns "1 stroke", "2 strokes".
std::string counted(std::size_t count, std::string_view noun);

/// Returns "once", "twice", "3 times".
std::string how_often(std::size_t count);

/// Returns the number with `digits` significant digits, never with an exponent: 1230, 12.0,
/// 0.00123.
std::string rounded(double value, int digits = 3);

/// Like rounded(), but without zeros at the end: 12, 0.5.
std::string trimmed(double value, int digits = 6);

/// Returns a length in a suitable unit: mm, µm or nm.
std::string length_text(double mm);

/// Returns a time in a suitable unit: µs, ms or s.
std::string time_text(double us);

/// Returns the text with "u" instead of "µ", for tables whose columns count bytes.
std::string in_ascii(std::string text);

/// Returns the text as a terminal can show it: in_ascii(), unless LC_ALL, LC_CTYPE or LANG names
/// UTF-8.
std::string for_terminal(std::string text);

}  // namespace keepout::app
