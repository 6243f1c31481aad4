// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "serve/json_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace keepout::app {
namespace {

constexpr std::size_t longest_excerpt = 200;  // [bytes]

template <class Number>
void append_digits(std::string& text, Number value) {
  std::array<char, 32> digits;  // the longest double has 24
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

}  // namespace

void append_number(std::string& text, double value) {
  if (!std::isfinite(value)) {
    text += "null";
  } else if (value == 0.0) {
    text += std::signbit(value) ? "-0.0" : "0";
  } else {
    append_digits(text, value);
  }
}

void append_count(std::string& text, std::size_t value) { append_digits(text, value); }

void append_string(std::string& text, std::string_view value) {
  constexpr std::string_view hex = "0123456789abcdef";
  text += '"';
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (byte < 0x20) {
      text += "\\u00";
      text += hex[byte >> 4];
      text += hex[byte & 15];
    } else {
      text += c;
    }
  }
  text += '"';
}

void append_printable(std::string& text, std::string_view value) {
  for (const char c : value.substr(0, longest_excerpt)) text += c >= ' ' && c <= '~' ? c : '?';
  if (value.size() > longest_excerpt) text += "...";
}

void append_quoted(std::string& text, std::string_view value) {
  text += '\'';
  append_printable(text, value);
  text += '\'';
}

}  // namespace keepout::app
