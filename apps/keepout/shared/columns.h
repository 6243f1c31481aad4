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

/// [x, y, z]
inline Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// As a table shows what has no form of its own: text as it is, numbers with all their digits.
inline std::string plain(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// JSON has no infinity.
inline Json or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// A count with its thousands set apart; "-" for null.
inline std::string count_text(const Json& value) {
  return value.is_null() ? "-" : grouped(value.get<std::uint64_t>());
}

/// So many significant digits; "-" for null.
template <int digits = 3>
std::string figure_text(const Json& value) {
  return value.is_null() ? "-" : rounded(value.get<double>(), digits);
}

/// The format of a number, by the rules of printf, as the argument of a template.
template <std::size_t size>
struct NumberFormat {
  constexpr NumberFormat(const char (&from)[size]) { std::copy_n(from, size, text); }
  char text[size];
};
/// A number in that format; "-" for null.
template <NumberFormat format>
std::string number_text(const Json& value) {
  return value.is_null() ? "-" : formatted(format.text, value.get<double>());
}

/// One figure of the rows of a table: what JSON calls it, where it comes from, and how a table for
/// a terminal shows it.
template <class Row>
struct Column {
  std::string key;                        // empty: not in JSON
  std::function<Json(const Row&)> value;  // or a member of the row
  std::string heading = {};               // in the table
  /// In the table, at least; below 0: to the left; 0: not in the table. [characters]
  int width = 0;
  std::string (*text)(const Json&) = &plain;  // in the table
};
template <class Row>
using Columns = std::vector<Column<Row>>;

/// {"key": value, ...}
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

/// A line of the table, without its end: what `text` says of each column.
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

/// All of it.
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
