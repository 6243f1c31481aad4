// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "keepout/geometry/shapes.h"
#include "shared/number_text.h"

namespace keepout::app {

using Json = nlohmann::ordered_json;

/// Returns [x, y, z].
inline Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Returns the default text of a value in a table: text as it is, numbers with all their digits.
inline std::string plain(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// Returns null for infinity and NaN, which JSON cannot represent.
inline Json or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// Returns a count with thousands separators; "-" for null.
inline std::string count_text(const Json& value) {
  return value.is_null() ? "-" : grouped(value.get<std::uint64_t>());
}

/// Returns a number with `digits` significant digits; "-" for null.
template <int digits = 3>
std::string figure_text(const Json& value) {
  return value.is_null() ? "-" : rounded(value.get<double>(), digits);
}

/// A printf format of a number, as a template argument.
template <std::size_t size>
struct NumberFormat {
  constexpr NumberFormat(const char (&from)[size]) { std::copy_n(from, size, text); }
  char text[size];
};
/// Returns a number in this format; "-" for null.
template <NumberFormat format>
std::string number_text(const Json& value) {
  return value.is_null() ? "-" : formatted(format.text, value.get<double>());
}

/// A column of a table: its key in JSON, its value in a row, and its form on a terminal.
template <class Row>
struct Column {
  std::string key;                        // empty: not in JSON
  std::function<Json(const Row&)> value;  // a function of the row, or a member of it
  std::string heading = {};               // on a terminal
  /// The least width on a terminal; negative: left-aligned; 0: not on a terminal. [characters]
  int width = 0;
  std::string (*text)(const Json&) = &plain;  // on a terminal
};
template <class Row>
using Columns = std::vector<Column<Row>>;

/// Returns {"key": value, ...}.
template <class Row>
Json json_of(const Columns<Row>& columns, const Row& row) {
  Json json = Json::object();
  for (const Column<Row>& column : columns) {
    if (!column.key.empty()) json[column.key] = column.value(row);
  }
  return json;
}

template <class Row>
Json json_of(const Columns<Row>& columns, const std::vector<Row>& rows) {
  Json list = Json::array();
  for (const Row& row : rows) list.push_back(json_of(columns, row));
  return list;
}

/// Prints a line of the table, without its end: the `text` of each column.
template <class Row, class Text>
void print_cells(std::ostream& out, const Columns<Row>& columns, const Text& text) {
  const char* between = "";
  for (const Column<Row>& column : columns) {
    if (column.width == 0) continue;
    out << std::exchange(between, " ") << (column.width < 0 ? std::left : std::right)
        << std::setw(std::abs(column.width)) << text(column);
  }
}

template <class Row>
void print_headings(std::ostream& out, const Columns<Row>& columns) {
  print_cells(out, columns, [](const Column<Row>& column) { return column.heading; });
}

template <class Row>
void print_row(std::ostream& out, const Columns<Row>& columns, const Row& row) {
  print_cells(out, columns, [&](const Column<Row>& c) { return c.text(c.value(row)); });
}

/// Prints the headings and all rows.
template <class Row>
void print_rows(std::ostream& out, const Columns<Row>& columns, const std::vector<Row>& rows) {
  print_headings(out, columns);
  out << '\n';
  for (const Row& row : rows) {
    print_row(out, columns, row);
    out << '\n';
  }
}

}  // namespace keepout::app
