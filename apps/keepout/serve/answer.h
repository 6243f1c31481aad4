// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstddef>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "keepout/robot/instrument_step.h"
#include "keepout/step/motion_constraint.h"

namespace keepout::app {

// Each answer is one line of JSON. These functions append to the text of the answers.

/// Appends the shortest digits that read back as the same double; null for a number that is not
/// finite. Appends "-0.0" for a negative zero, so that no reader takes it for an integer.
void append_number(std::string& out, double value);

/// Appends a string in quotes. `value`: UTF-8.
void append_string(std::string& out, std::string_view value);

/// Appends a number, a text, a truth value, an array of values, or an object whose members a
/// function appends.
template <class Value>
void append_value(std::string& out, Value&& value) {
  using Plain = std::remove_cvref_t<Value>;
  if constexpr (std::same_as<Plain, bool>) {
    out += value ? "true" : "false";
  } else if constexpr (std::integral<Plain>) {
    out += std::to_string(value);
  } else if constexpr (std::floating_point<Plain>) {
    append_number(out, value);
  } else if constexpr (std::convertible_to<Plain, std::string_view>) {
    append_string(out, value);
  } else if constexpr (std::ranges::range<Plain>) {
    out += '[';
    for (bool is_first = true; auto&& item : value) {
      if (!std::exchange(is_first, false)) out += ',';
      append_value(out, item);
    }
    out += ']';
  } else {
    out += '{';
    value(out);
    out += '}';
  }
}

/// Appends a member of an object, after a comma unless it is the first.
template <class Value>
void append_member(std::string& out, std::string_view key, Value&& value) {
  if (!out.ends_with('{')) out += ',';
  append_string(out, key);
  out += ':';
  append_value(out, value);
}

/// Appends the members of a step. `joints`: the columns of its Jacobian; 0 without a Jacobian.
void append_step(std::string& out, const Step& step, std::size_t joints);

/// Appends the members of a polytope.
void append_polytope(std::string& out, const Polytope& polytope);

/// Appends the members of a step of an instrument with `joints` joints.
void append_joint_step(std::string& out, const InstrumentStep& step, std::size_t joints);

/// Appends the state of each guide of a step, by name, and the relaxed constraints. Appends nothing
/// without guides.
void append_guides(std::string& out, std::span<const std::string> names,
                   std::span<const GuideState> states, Relaxation relaxation);

/// Appends the complete answer to a line that was not carried out. `id`: JSON.
void append_error(std::string& out, std::string_view id, std::string_view kind,
                  std::string_view message);

}  // namespace keepout::app
