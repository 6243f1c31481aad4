// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <ranges>
#include <span>
#include <string>
#include <string_view>

#include "keepout/robot/instrument_step.h"
#include "keepout/step/motion_constraint.h"

namespace keepout::app {

// Answers are one line of JSON each. These functions append to the text that is to be sent.

/// Appends the shortest digits that read back as the same double; "-0.0" for a negative zero, so
/// that no reader takes it for an integer; null for a number that is not finite.
void append_number(std::string& out, double value);

/// Appends a string in quotes. `value`: UTF-8.
void append_string(std::string& out, std::string_view value);

/// Appends `"key":`, after a comma unless it is the first member of its object.
void append_key(std::string& out, std::string_view key);

/// Appends an array. `append`: called with each item, appends it.
template <std::ranges::input_range Items, class Append>
void append_array(std::string& out, Items&& items, const Append& append) {
  out += '[';
  for (bool is_first = true; const auto& item : items) {
    if (!is_first) out += ',';
    is_first = false;
    append(item);
  }
  out += ']';
}

/// Appends a member of an object. `value`: a number, a text, a truth value, or an array of numbers.
template <class Value>
void append_member(std::string& out, std::string_view key, const Value& value) {
  append_key(out, key);
  if constexpr (std::same_as<Value, bool>) {
    out += value ? "true" : "false";
  } else if constexpr (std::integral<Value>) {
    out += std::to_string(value);
  } else if constexpr (std::floating_point<Value>) {
    append_number(out, value);
  } else if constexpr (std::convertible_to<Value, std::string_view>) {
    append_string(out, value);
  } else {
    append_array(out, value, [&](double number) { append_number(out, number); });
  }
}

/// Appends the members of a step. `joints`: of its Jacobian; 0 without one.
void append_step(std::string& out, const Step& step, std::size_t joints);

/// Appends the members of a polytope.
void append_polytope(std::string& out, const Polytope& polytope);

/// Appends the members of a step of an instrument of so many joints.
void append_joint_step(std::string& out, const InstrumentStep& step, std::size_t joints);

/// Appends the state of each guide of a step, by name, and the relaxed constraints; nothing without
/// guides.
void append_guides(std::string& out, std::span<const std::string> names,
                   std::span<const GuideState> states, Relaxation relaxation);

/// Appends the whole answer to a line that was not carried out. `id`: JSON.
void append_error(std::string& out, std::string_view id, std::string_view kind,
                  std::string_view message);

}  // namespace keepout::app
