// SPDX-License-Identifier: BSD-3-Clause
#include "record/flat_rows.h"

#include <algorithm>
#include <ostream>
#include <utility>

namespace keepout::app {
namespace {

using Cells = std::vector<std::pair<std::string, Json>>;

void add_cells(const Json& object, const std::string& before, Cells& cells) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) add_cells(value, before + key + '_', cells);
    if (value.is_primitive()) cells.emplace_back(before + key, value);
  }
}

/// Adds the new names of a row to the columns, each after the column that precedes it in the row.
void add_columns(const Cells& cells, std::vector<std::string>& columns) {
  std::size_t at = 0;
  for (const auto& [name, value] : cells) {
    const auto known = std::ranges::find(columns, name);
    if (known != columns.end()) {
      at = static_cast<std::size_t>(known - columns.begin()) + 1;
    } else {
      columns.insert(columns.begin() + static_cast<std::ptrdiff_t>(at++), name);
    }
  }
}

/// Returns the value in a column; null if the row does not have it.
Json cell_of(const Cells& cells, const std::string& column) {
  const auto cell = std::ranges::find(cells, column, &Cells::value_type::first);
  return cell == cells.end() ? Json() : cell->second;
}

std::string csv_cell(const Json& value) {
  if (value.is_null()) return "";
  const std::string text = plain(value);
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

FlatRows flat(const Json& rows) {
  FlatRows table;
  std::vector<Cells> lines;
  for (const Json& row : rows) {
    add_cells(row, "", lines.emplace_back());
    add_columns(lines.back(), table.columns);
  }
  // A value that is an object in one row and null in another needs no column of its own.
  std::erase_if(table.columns, [&](const std::string& column) {
    return std::ranges::any_of(table.columns, [&](const std::string& other) {
      return other.starts_with(column + '_') && std::ranges::all_of(lines, [&](const Cells& cells) {
               return cell_of(cells, column).is_null();
             });
    });
  });
  for (const Cells& cells : lines) {
    std::vector<Json>& row = table.rows.emplace_back();
    for (const std::string& column : table.columns) row.push_back(cell_of(cells, column));
  }
  return table;
}

void print_csv(std::ostream& out, const FlatRows& table) {
  const auto print_line = [&](const auto& cells, const auto& text) {
    const char* between = "";
    for (const auto& cell : cells) out << std::exchange(between, ",") << text(cell);
    out << '\n';
  };
  print_line(table.columns, [](const std::string& name) { return name; });
  for (const std::vector<Json>& row : table.rows) print_line(row, csv_cell);
}

}  // namespace keepout::app
