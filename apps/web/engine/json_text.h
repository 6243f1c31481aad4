// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <string_view>

#include "keepout/geometry/shapes.h"

namespace keepout::web {

/// A number as JSON, which reads back exactly. Precondition: it is finite.
inline std::string json(double number) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.17g", number);
  return text.data();
}

/// The same for what counts.
inline std::string json(std::size_t number) { return std::to_string(number); }
/// The same for the number of a vertex.
inline std::string json(VertexId number) { return std::to_string(number); }

/// Text as a JSON string. What is not UTF-8 in it stays so.
inline std::string json(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return quoted += '"';
}

/// Anything that can be walked through, as a JSON list of what `item` makes of each.
template <class Range, class Item>
std::string json_list(const Range& range, const Item& item) {
  std::string text = "[";
  for (const auto& each : range) text.append(text.size() > 1 ? "," : "").append(item(each));
  return text += ']';
}

/// The same for what has a JSON text of its own.
template <class Range>
std::string json_list(const Range& range) {
  return json_list(range, [](const auto& each) { return json(each); });
}

}  // namespace keepout::web
