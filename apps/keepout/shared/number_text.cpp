// SPDX-License-Identifier: BSD-3-Clause
#include "shared/number_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace keepout::app {

std::string grouped(std::size_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
  return digits;
}

std::string counted(std::size_t count, std::string_view noun) {
  std::string result = grouped(count) + ' ';
  result += noun;
  if (count == 1) return result;
  if (noun.ends_with("ex")) return result.replace(result.size() - 2, 2, "ices");
  return result + (noun.ends_with("s") || noun.ends_with("sh") ? "es" : "s");
}

std::string how_often(std::size_t count) {
  return count == 1 ? "once" : count == 2 ? "twice" : counted(count, "time");
}

std::string rounded(double value, int digits) {
  if (!std::isfinite(value)) return "?";
  if (value == 0.0) return "0";
  const int magnitude = static_cast<int>(std::floor(std::log10(std::abs(value))));
  const int decimals = std::clamp(digits - 1 - magnitude, 0, 9);
  return formatted("%.*f", decimals,
                   value);  // this buffer must hold 309 digits of the largest double
}

std::string trimmed(double value, int digits) {
  std::string text = rounded(value, digits);
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string length_text(double mm) {
  const double size = std::abs(mm);
  if (size == 0.0) return "0 mm";
  if (size >= 0.01) return rounded(mm) + " mm";
  if (size >= 1e-5) return rounded(1e3 * mm) + " µm";
  if (size >= 1e-6) return rounded(1e6 * mm) + " nm";
  return "under 1 nm";
}

std::string time_text(double us) {
  if (us >= 1e7) return rounded(1e-6 * us) + " s";
  return us >= 1e4 ? rounded(1e-3 * us) + " ms" : rounded(us) + " µs";
}

std::string in_ascii(std::string text) {
  constexpr std::string_view micro = "µ";
  for (std::size_t at = 0; (at = text.find(micro, at)) != std::string::npos;) {
    text.replace(at, micro.size(), "u");
  }
  return text;
}

std::string for_terminal(std::string text) {
  for (const char* variable : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* const value = std::getenv(variable);
    if (value == nullptr || *value == '\0') continue;
    std::string locale = value;
    for (char& c : locale) c = static_cast<char>(c | ' ');  // to lower case
    const bool is_utf8 =
        locale.find("utf-8") != std::string::npos || locale.find("utf8") != std::string::npos;
    return is_utf8 ? text : in_ascii(std::move(text));
  }
  return in_ascii(std::move(text));
}

}  // namespace keepout::app
