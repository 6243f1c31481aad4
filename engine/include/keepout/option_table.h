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
#include <utility>
#include <variant>

#include "keepout/geometry/shapes.h"

namespace keepout {

// A table of options describes each member of a struct of options once: name, unit, range and
// meaning. The range checks, the Python module and its stubs, `keepout serve`, the commands and
// docs/options.md use the table.

/// The allowed numbers of an option: from `least` to `most`, and 0 if `has_zero`.
struct Range {
  double least = 0.0;     // end of the range, included
  double most = 0.0;      // end of the range, included
  bool has_zero = false;  // 0 is allowed too
};

/// Returns the range of numbers above 0 and at most `most`.
constexpr Range above_zero(double most) {
  return {std::numeric_limits<double>::denorm_min(), most};
}

inline constexpr Range positive_length{shortest_length, longest_length};       // a length above 0
inline constexpr Range zero_or_length{shortest_length, longest_length, true};  // or 0
inline constexpr Range not_negative{0.0, longest_length};  // also below shortest_length

/// The kind of value of an option.
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
  std::string_view name;                         // in Python and in serve
  std::string_view meaning;                      // one sentence
  OptionKind kind = OptionKind::number;          // of the value
  std::string_view unit = {};                    // of a number; empty if it has none
  Range range = {};                              // of a number or a whole number
  std::span<const std::string_view> names = {};  // of a choice
  std::string_view command = {};                 // the name for the commands, if different

  /// Returns the name for the commands, without "--": `command`, or `name` with '-' for '_'.
  std::string flag() const;

  /// Returns a description of the allowed values. Allocates.
  std::string expected() const;

  /// Returns the value of a text. Throws Error for a value that is not allowed.
  OptionValue parsed(const std::string& text) const;

  /// Returns a value as the option stores it: a whole number is converted if the option is a
  /// number. Throws Error, which states the option, the allowed values and the given value, for a
  /// value that is not allowed.
  OptionValue accepted(OptionValue value) const;

  /// Throws Error for a value that is not allowed.
  [[noreturn]] void refuse(std::string_view given) const;
};

/// An option that is a member of the struct `Options`.
template <class Options>
struct Option : OptionText {
  OptionValue (*get)(const Options&) = nullptr;         // reads the member
  void (*put)(Options&, const OptionValue&) = nullptr;  // writes it; precondition: accepted()

  /// Sets the member. Throws Error for a value that is not allowed.
  void set(Options& options, OptionValue value) const { put(options, accepted(std::move(value))); }
};

/// Returns a value as text interfaces write it: 0.2, 3, true, motion.
std::string text_of(const OptionValue& value);

namespace detail {

template <class Options, class Value>
Options options_of(Value Options::*);
template <class Options, class Value>
Value value_of(Value Options::*);

inline constexpr std::array<std::string_view, 0> no_names{};

/// Removes the meanings of options from programs that do not show them, such as the module of the
/// web pages.
constexpr std::string_view kept_meaning([[maybe_unused]] std::string_view meaning) {
#ifdef KEEPOUT_NO_MEANINGS
  return {};
#else
  return meaning;
#endif
}

}  // namespace detail

/// Describes a member of a struct of options. The type of the member gives the kind. An enumeration
/// is a choice of `Names`, the names of its values from 0 on. Unit, range and command: see
/// OptionText.
template <auto Member, const auto& Names = detail::no_names>
constexpr auto option(std::string_view name, std::string_view unit, Range range,
                      std::string_view meaning, std::string_view command = {}) {
  using Options = decltype(detail::options_of(Member));
  using Value = decltype(detail::value_of(Member));
  constexpr bool is_stored = std::same_as<Value, bool> || std::same_as<Value, double>;
  using Stored =
      std::conditional_t<is_stored, Value,
                         std::conditional_t<std::integral<Value>, std::int64_t, std::string>>;
  constexpr OptionKind kind = std::same_as<Value, double> ? OptionKind::number
                              : std::same_as<Value, bool> ? OptionKind::flag
                              : std::integral<Value>      ? OptionKind::whole_number
                              : std::is_enum_v<Value>     ? OptionKind::choice
                                                          : OptionKind::part;
  Option<Options> option{{name, detail::kept_meaning(meaning), kind, unit, range, Names, command}};
  option.get = [](const Options& o) -> OptionValue {
    if constexpr (std::is_enum_v<Value>) {
      const auto value = static_cast<std::size_t>(o.*Member);
      return std::string(value < Names.size() ? Names[value] : "no value");
    } else {
      return static_cast<Stored>(o.*Member);
    }
  };
  option.put = [](Options& o, const OptionValue& v) {
    if constexpr (std::is_enum_v<Value>) {
      std::size_t value = 0;
      while (Names[value] != std::get<std::string>(v)) ++value;
      o.*Member = static_cast<Value>(value);
    } else {
      o.*Member = static_cast<Value>(std::get<Stored>(v));
    }
  };
  return option;
}

/// Describes a member without unit and range.
template <auto Member, const auto& Names = detail::no_names>
constexpr auto option(std::string_view name, std::string_view meaning) {
  return option<Member, Names>(name, {}, {}, meaning);
}

/// Returns the option of that name. Precondition: the table has such an option.
template <class Table>
constexpr const auto& option_named(const Table& table, std::string_view name) {
  const auto* option = table.data();
  while (option->name != name) ++option;
  return *option;
}

/// Throws Error, which names the option, if the value of an option is not allowed.
template <class Table, class Options>
void require_in_range(const Table& table, const Options& options) {
  for (const auto& option : table) option.accepted(option.get(options));
}

}  // namespace keepout
