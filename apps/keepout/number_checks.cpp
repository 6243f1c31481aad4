// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "number_checks.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>
#include <system_error>

namespace keepout::app {

CLI::Validator length(Zero zero) {
  const auto check = [zero](const std::string& text) -> std::string {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    const bool is_number = !text.empty() && *end == '\0';
    const bool in_range = (zero == Zero::allowed ? value >= 0.0 : value > 0.0) && value <= 1e30;
    if (is_number && in_range) return {};
    return "expected a number " +
           std::string(zero == Zero::allowed ? "from 0 to 1e30" : "above 0 and at most 1e30") +
           ", not '" + text + "'";
  };
  return {check, zero == Zero::allowed ? "NONNEGATIVE" : "POSITIVE"};
}

CLI::Validator whole_number(std::uint64_t low, std::uint64_t high) {
  const auto check = [low, high](std::string& text) -> std::string {
    std::uint64_t value = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value);
    if (error != std::errc{} || end != last || value < low || value > high) {
      return "expected a whole number from " + std::to_string(low) + " to " + std::to_string(high) +
             ", not '" + text + "'";
    }
    text = std::to_string(value);
    return {};
  };
  return {check, ""};
}

CLI::Validator large_count() {
  const auto check = [](std::string& text) -> std::string {
    double value = 0.0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value);
    if (error != std::errc{} || end != last || !(value >= 1.0 && value <= 1e12) ||
        value != std::floor(value)) {
      return "expected a whole number from 1 to 1e12, not '" + text + "'";
    }
    text = std::to_string(static_cast<std::uint64_t>(value));
    return {};
  };
  return {check, ""};
}

}  // namespace keepout::app
