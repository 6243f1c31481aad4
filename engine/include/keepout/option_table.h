// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "keepout/geometry/shapes.h"

namespace keepout {

// A table of options names each member of a struct of options once, with its unit, its range and a
// sentence. The range checks, the Python module and its stubs, `keepout serve`, the commands and
// docs/options.md read it.

/// Numbers that an option may have: those from `least` to `most`, and 0 if `has_zero`.
struct Range {
  double least = 0.0;
  double most = 0.0;
  bool has_zero = false;
};

/// Above 0, and at most `most`.
constexpr Range above_zero(double most) {
  return {std::numeric_limits<double>::denorm_min(), most};
}

inline constexpr Range positive_length{shortest_length, longest_length};    // a length above 0
inline constexpr Range zero_or_length{shortest_length, longest_length, true};  // or none
inline constexpr Range not_negative{0.0, longest_length};  // of any size, however small

/// What kind of value an option has.
enum class OptionKind : std::uint8_t {
  number,
  whole_number,
  flag,    // true or false
  choice,  // one of the names in OptionText::names
  part     // the name of a part, which the part's registry checks
};

/// A value of an option. A choice and a part are strings.
using OptionValue = std::variant<double, std::int64_t, bool, std::string>;

/// Describes an option to people and to programs.
struct OptionText {
  std::string_view name;     // in Python and serve; of the commands with '-' for '_'
  std::string_view meaning;  // one sentence
  OptionKind kind = OptionKind::number;
  std::string_view unit = {};  // of a number; empty if it has none
  Range range = {};            // of a number or a whole number
  std::span<const std::string_view> names = {};  // of a choice
  std::string_view flag = {};                    // of the commands, if it differs from `name`

  /// Returns the values that the option may have, in words. Allocates.
  std::string expected() const;

  /// Returns the value that a text stands for. Throws Error for a value that the option may not have.
  OptionValue parsed(const std::string& text) const;

  /// Returns a value as the option stores it: a whole number for a number becomes one. Throws Error,
  /// naming the option, what was expected and what was given, for a value that it may not have.
  OptionValue accepted(OptionValue value) const;

  /// Throws Error for a value that the option may not have.
  [[noreturn]] void refuse(std::string_view given) const;
};

/// An option that is a member of `Options`.
template <class Options>
struct Option : OptionText {
  OptionValue (*get)(const Options&) = nullptr;       // reads the member
  void (*put)(Options&, const OptionValue&) = nullptr;  // writes it; precondition: accepted()

  /// Sets the member. Throws Error for a value that the option may not have.
  void set(Options& options, OptionValue value) const { put(options, accepted(std::move(value))); }
};

/// Returns a value as text interfaces write it: 0.2, 3, true, motion.
std::string text_of(const OptionValue& value);

namespace detail {

template <class Options, class Value>
Options options_of(Value Options::*);
template <class Options, class Value>
Value value_of(Value Options::*);

template <auto Member>
constexpr auto option_of(OptionText text) {
  using Options = decltype(options_of(Member));
  using Value = decltype(value_of(Member));
  using Stored =
      std::conditional_t<std::same_as<Value, bool> || std::same_as<Value, double>, Value,
                         std::conditional_t<std::integral<Value>, std::int64_t, std::string>>;
  Option<Options> option{text};
  option.get = [](const Options& o) { return OptionValue(static_cast<Stored>(o.*Member)); };
  option.put = [](Options& o, const OptionValue& v) {
    o.*Member = static_cast<Value>(std::get<Stored>(v));
  };
  return option;
}

}  // namespace detail

/// An option that is a number or a whole number. `flag`: see OptionText.
template <auto Member>
constexpr auto option(std::string_view name, std::string_view unit, Range range,
                      std::string_view meaning, std::string_view flag = {}) {
  const bool is_real = std::same_as<decltype(detail::value_of(Member)), double>;
  return detail::option_of<Member>(
      {name, meaning, is_real ? OptionKind::number : OptionKind::whole_number, unit, range, {}, flag});
}

/// An option that is true or false, or the name of a part.
template <auto Member>
constexpr auto option(std::string_view name, std::string_view meaning) {
  const bool is_flag = std::same_as<decltype(detail::value_of(Member)), bool>;
  return detail::option_of<Member>(
      {.name = name, .meaning = meaning, .kind = is_flag ? OptionKind::flag : OptionKind::part});
}

/// An option that is an enumeration, whose values from 0 on have these `Names`.
template <auto Member, const auto& Names>
constexpr auto option(std::string_view name, std::string_view meaning) {
  using Options = decltype(detail::options_of(Member));
  using Enum = decltype(detail::value_of(Member));
  Option<Options> option{{.name = name, .meaning = meaning, .kind = OptionKind::choice, .names = Names}};
  option.get = [](const Options& o) {
    const auto value = static_cast<std::size_t>(o.*Member);
    return OptionValue(std::string(value < Names.size() ? Names[value] : "no value"));
  };
  option.put = [](Options& o, const OptionValue& v) {
    std::size_t value = 0;
    while (Names[value] != std::get<std::string>(v)) ++value;
    o.*Member = static_cast<Enum>(value);
  };
  return option;
}

/// Throws Error, naming the option, unless each of the options has a value that it may have.
template <class Table, class Options>
void require_in_range(const Table& table, const Options& options) {
  for (const auto& option : table) option.accepted(option.get(options));
}

}  // namespace keepout
