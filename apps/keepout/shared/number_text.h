// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace keepout::app {

/// By the rules of printf, up to 511 bytes.
template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 512> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

/// A count with its thousands set apart: 24,000.
std::string grouped(std::size_t count);

/// "1 stroke", "2 strokes".
std::string counted(std::size_t count, std::string_view noun);

/// "once", "twice", "3 times".
std::string how_often(std::size_t count);

/// Three significant digits, or as many as asked for, never an exponent: 1230, 12.0, 0.00123.
std::string rounded(double value, int digits = 3);

/// The same without zeros at the end: 12, 0.5.
std::string trimmed(double value, int digits = 6);

/// A length in the unit that suits it: mm, µm or nm.
std::string length_text(double mm);

/// A time in the unit that suits it: µs, ms or s.
std::string time_text(double us);

/// The text with "u" for the "µ" of our units: in ASCII, for tables whose columns count bytes.
std::string in_ascii(std::string text);

/// The text as a terminal can show it: in_ascii(), unless LC_ALL, LC_CTYPE or LANG names UTF-8.
std::string for_terminal(std::string text);

}  // namespace keepout::app
