// SPDX-License-Identifier: BSD-3-Clause
#include "record/plain_page.h"

#include <algorithm>
#include <ostream>
#include <utility>
#include <vector>

#include "number_text.h"

namespace keepout::app {
namespace {

constexpr const char* style =
    "body{font:16px/1.5 system-ui,sans-serif;max-width:72em;margin:2em auto;padding:0 1em}"
    ".scroll{overflow:auto;max-height:40em}table{border-collapse:collapse;font-size:14px}"
    "th,td{padding:4px 8px;border-bottom:1px solid #8886;text-align:left;vertical-align:top}";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    result += c == '&'   ? "&amp;"
              : c == '<' ? "&lt;"
              : c == '>' ? "&gt;"
              : c == '"' ? "&quot;"
                         : std::string(1, c);
  }
  return result;
}

std::string cell_text(const Json& value) {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_integer() && value >= 0) return grouped(value.get<std::size_t>());
  return value.is_number() ? trimmed(value.get<double>()) : value.dump();
}

using Cells = std::vector<std::pair<std::string, Json>>;

/// What of an object can be told in one row; objects within have their members there too.
void add_cells(const Json& object, const std::string& before, Cells& cells) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) {
      add_cells(value, before + key + ' ', cells);
    } else if (value.is_primitive()) {
      cells.emplace_back(before + key, value);
    }
  }
}

void print_table(std::ostream& out, const std::string& title, const Json& rows) {
  std::vector<std::string> columns;
  std::vector<Cells> lines;
  for (const Json& row : rows) {
    add_cells(row, "", lines.emplace_back());
    for (const auto& [name, value] : lines.back()) {
      if (std::ranges::find(columns, name) == columns.end()) columns.push_back(name);
    }
  }
  out << "<h2>" << escaped(title) << "</h2>\n<div class=\"scroll\"><table><thead><tr>";
  for (const std::string& column : columns) out << "<th>" << escaped(column) << "</th>";
  out << "</tr></thead>\n<tbody>\n";
  for (const Cells& cells : lines) {
    out << "<tr>";
    for (const std::string& column : columns) {
      const auto cell = std::ranges::find(cells, column, &std::pair<std::string, Json>::first);
      out << "<td>" << (cell == cells.end() ? "" : escaped(cell_text(cell->second))) << "</td>";
    }
    out << "</tr>\n";
  }
  out << "</tbody></table></div>\n";
}

void print_member(std::ostream& out, const std::string& name, const Json& value) {
  if (value.is_array() && !value.empty() && value.front().is_object()) {
    print_table(out, name, value);
  } else if (value.is_object() && !value.contains("packed")) {
    Cells cells;
    for (const auto& [key, member] : value.items()) {
      if (member.is_primitive()) cells.emplace_back(key, member);
    }
    if (!cells.empty()) {
      out << "<h2>" << escaped(name) << "</h2>\n<table>";
      for (const auto& [key, member] : cells) {
        out << "<tr><th>" << escaped(key) << "</th><td>" << escaped(cell_text(member))
            << "</td></tr>\n";
      }
      out << "</table>\n";
    }
    for (const auto& [key, member] : value.items()) print_member(out, name + ", " + key, member);
  }
}

}  // namespace

void print_plain_page(std::ostream& out, const Json& record) {
  const std::string headline = escaped(record.at("headline").get<std::string>());
  out << "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      << "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" << headline
      << "</title>\n<style>" << style << "</style>\n</head>\n<body>\n<p>"
      << escaped(record.at("subject").get<std::string>()) << "</p>\n<h1>" << headline << "</h1>\n";
  for (const Json& text : record.at("account")) {
    out << "<p>" << escaped(text.get<std::string>()) << "</p>\n";
  }
  out << "<p>Made again by: <code>" << escaped(record.at("command").get<std::string>())
      << "</code></p>\n";
  for (const auto& [key, value] : record.items()) print_member(out, key, value);
  out << "</body>\n</html>\n";
}

}  // namespace keepout::app
