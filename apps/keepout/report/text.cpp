// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "report/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace keepout::app {

std::string escape(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string grouped(std::size_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
  return digits;
}

std::string counted(std::size_t count, std::string_view noun) {
  std::string result = grouped(count) + ' ';
  result += noun;
  if (count != 1) result += noun.ends_with("s") ? "es" : "s";
  return result;
}

std::string rounded(double value) {
  if (!std::isfinite(value)) return "?";
  if (value == 0.0) return "0";
  const int magnitude = static_cast<int>(std::floor(std::log10(std::abs(value))));
  const int decimals = std::clamp(2 - magnitude, 0, 9);
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string length_text(double mm) {
  const double size = std::abs(mm);
  if (size == 0.0) return "0\u00a0mm";
  if (size >= 0.01) return rounded(mm) + "\u00a0mm";
  if (size >= 1e-5) return rounded(1e3 * mm) + "\u00a0µm";
  if (size >= 1e-6) return rounded(1e6 * mm) + "\u00a0nm";
  return "under 1\u00a0nm";
}

std::string listed(const std::vector<std::string>& names) {
  std::string result;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) result += i + 1 == names.size() ? " and " : ", ";
    result += names[i];
  }
  return result;
}

}  // namespace keepout::app
