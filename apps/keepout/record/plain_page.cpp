// SPDX-License-Identifier: BSD-3-Clause
#include "record/plain_page.h"

#include <ostream>
#include <span>
#include <vector>

#include "page/base64.h"
#include "record/flat_rows.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

constexpr const char* style =
    "body{font:16px/1.5 system-ui,sans-serif;max-width:72em;margin:2em auto;padding:0 1em}"
    ".scroll{overflow:auto;max-height:40em}table{border-collapse:collapse;font-size:14px}"
    "th,td{padding:4px 8px;border-bottom:1px solid #8886;text-align:left;vertical-align:top}"
    "figure{margin:1em 0}img{max-width:100%}";

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

void print_table(std::ostream& out, const std::string& title, const FlatRows& table) {
  out << "<h2>" << escaped(title) << "</h2>\n<div class=\"scroll\"><table><thead><tr>";
  for (const std::string& column : table.columns) out << "<th>" << escaped(column) << "</th>";
  out << "</tr></thead>\n<tbody>\n";
  for (const std::vector<Json>& row : table.rows) {
    out << "<tr>";
    for (const Json& cell : row) out << "<td>" << escaped(cell_text(cell)) << "</td>";
    out << "</tr>\n";
  }
  out << "</tbody></table></div>\n";
}

/// Prints an array of objects as a table, and the simple members of an object as another one.
void print_member(std::ostream& out, const std::string& name, const Json& value) {
  if (value.is_array() && !value.empty() && value.front().is_object()) {
    print_table(out, name, flat(value));
  } else if (value.is_object() && !value.contains("packed")) {
    Json plain = Json::array();
    for (const auto& [key, member] : value.items()) {
      if (member.is_primitive()) plain.push_back({{"", key}, {"value", member}});
    }
    if (!plain.empty()) print_table(out, name, flat(plain));
    for (const auto& [key, member] : value.items()) print_member(out, name + ", " + key, member);
  }
}

void print_paragraph(std::ostream& out, const Json& text) {
  if (text != "") out << "<p>" << escaped(text.get<std::string>()) << "</p>\n";
}

/// Prints a picture as an image, so that it can neither run scripts nor load anything.
void print_figure(std::ostream& out, const Json& figure) {
  const std::string picture = figure.at("svg").get<std::string>();
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(picture.data()), picture.size());
  const std::string title = escaped(figure.at("title").get<std::string>());
  out << "<figure><img alt=\"" << title << "\" src=\"data:image/svg+xml;base64," << to_base64(bytes)
      << "\"><figcaption><b>" << title << "</b> "
      << escaped(figure.at("caption").get<std::string>()) << "</figcaption></figure>\n";
}

/// Prints the published numbers of all experiments beside ours, then the results of each
/// experiment.
void print_experiments(std::ostream& out, const Json& experiments) {
  Json claims = Json::array();
  for (const Json& experiment : experiments) {
    for (const Json& claim : experiment.at("claims")) {
      claims.push_back({{"experiment", experiment.at("title")}});
      claims.back().update(claim);
    }
  }
  print_table(out, "Compared with Li et al. (2020)", flat(claims));
  for (const Json& experiment : experiments) {
    const std::string title = experiment.at("title").get<std::string>();
    out << "<h2>" << escaped(title) << "</h2>\n";
    print_paragraph(out, experiment.at("headline"));
    for (const Json& table : experiment.at("tables")) {
      print_table(out, table.at("title").get<std::string>(),
                  {table.at("columns").get<std::vector<std::string>>(),
                   table.at("rows").get<std::vector<std::vector<Json>>>()});
      print_paragraph(out, table.at("note"));
    }
    for (const Json& figure : experiment.at("figures")) print_figure(out, figure);
  }
}

}  // namespace

void print_plain_page(std::ostream& out, const Json& record) {
  const std::string headline = escaped(record.at("headline").get<std::string>());
  out << "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      << "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" << headline
      << "</title>\n<style>" << style << "</style>\n</head>\n<body>\n<p>"
      << escaped(record.at("subject").get<std::string>()) << "</p>\n<h1>" << headline << "</h1>\n";
  for (const Json& text : record.at("account")) print_paragraph(out, text);
  if (!record.at("complete").get<bool>()) {
    out << "<p><strong>The command was stopped: this page shows the finished part.</strong></p>\n";
  }
  out << "<p>Command that repeats it: <code>" << escaped(record.at("command").get<std::string>())
      << "</code></p>\n";
  if (record.contains("experiments")) print_experiments(out, record["experiments"]);
  for (const auto& [key, value] : record.items()) {
    if (key != "experiments") print_member(out, key, value);
  }
  out << "</body>\n</html>\n";
}

}  // namespace keepout::app
