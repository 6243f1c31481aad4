// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/option_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "keepout/error.h"

namespace keepout {
namespace {

template <class Number>
std::string digits_of(Number number) {
  std::array<char, 32> digits;  // the longest double has 24
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  std::string text(digits.data(), end);
  std::erase(text, '+');  // Exponents without a plus sign or leading zeros, such as 1e15.
  if (const std::size_t zero = text.find("e0"); zero != std::string::npos) text.erase(zero + 1, 1);
  return text;
}

template <class Number>
std::string expected_number(const Range& range) {
  const std::string most = digits_of(static_cast<Number>(range.most));
  const std::string what = std::same_as<Number, double> ? "a number" : "a whole number";
  if (range.least == std::numeric_limits<double>::denorm_min()) {
    return what + " above 0 and at most " + most;
  }
  return (range.has_zero ? "0 or " : "") + what + " from " +
         digits_of(static_cast<Number>(range.least)) + " to " + most;
}

bool contains(const Range& range, double number) {
  return (number >= range.least && number <= range.most) || (range.has_zero && number == 0.0);
}

/// Reads a whole text as a number. Returns false if it is not a number.
template <class Number>
bool read(const std::string& text, Number& number) {
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, number);
  return error == std::errc{} && end == last;
}

}  // namespace

std::string text_of(const OptionValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return digits_of(*number);
  if (const auto* number = std::get_if<std::int64_t>(&value)) return digits_of(*number);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  return std::get<std::string>(value);
}

std::string OptionText::flag() const {
  std::string flag(command.empty() ? name : command);
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

std::string OptionText::expected() const {
  switch (kind) {
    case OptionKind::number:
      return expected_number<double>(range);
    case OptionKind::whole_number:
      return expected_number<std::int64_t>(range);
    case OptionKind::flag:
      return "true or false";
    case OptionKind::part:
      return "a name";
    case OptionKind::choice:
      break;
  }
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    list += (i == 0 ? "'" : i + 1 < names.size() ? ", '" : " or '") + std::string(names[i]) + "'";
  }
  return list;
}

void OptionText::refuse(std::string_view given) const {
  throw Error(std::string(name) + ": expected " + expected() + ", got " + std::string(given));
}

OptionValue OptionText::parsed(const std::string& text) const {
  OptionValue value = text;
  double number = 0.0;
  std::int64_t whole = 0;
  if (kind == OptionKind::number && read(text, number)) value = number;
  if (kind == OptionKind::whole_number) {
    constexpr double most = 9007199254740992.0;  // 2^53: above it, doubles skip numbers
    const bool has_exponent = text.find_first_of("eE") != std::string::npos;
    if (read(text, whole)) value = whole;
    if (has_exponent && read(text, number) && number == std::floor(number) &&
        std::abs(number) <= most) {
      value = static_cast<std::int64_t>(number);  // 1e3
    }
  }
  if (kind == OptionKind::flag && (text == "true" || text == "false")) value = text == "true";
  return accepted(std::move(value));
}

OptionValue OptionText::accepted(OptionValue value) const {
  if (kind == OptionKind::choice) {  // names before version 0.3
    if (value == OptionValue(std::string("led_out"))) value = std::string("escape");
    if (value == OptionValue(std::string("linearised"))) value = std::string("linearized");
  }
  if (kind == OptionKind::number && std::holds_alternative<std::int64_t>(value)) {
    value = static_cast<double>(std::get<std::int64_t>(value));
  }
  const auto* const number = std::get_if<double>(&value);
  const auto* const whole = std::get_if<std::int64_t>(&value);
  const auto* const text = std::get_if<std::string>(&value);
  const bool is_accepted = kind == OptionKind::number
                               ? number != nullptr && contains(range, *number)
                           : kind == OptionKind::whole_number
                               ? whole != nullptr && contains(range, static_cast<double>(*whole))
                           : kind == OptionKind::flag ? std::holds_alternative<bool>(value)
                           : kind == OptionKind::part
                               ? text != nullptr
                               : text != nullptr && std::ranges::find(names, *text) != names.end();
  if (!is_accepted) refuse(text != nullptr ? "'" + *text + "'" : text_of(value));
  return value;
}

}  // namespace keepout
