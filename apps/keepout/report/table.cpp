// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "report/table.h"

#include <ostream>

#include "number_text.h"
#include "report/text.h"

namespace keepout::app {
namespace {

const char* open_cell(TableCell::Look look) {
  switch (look) {
    case TableCell::Look::number:
      return "<td>";
    case TableCell::Look::words:
      return "<td class=\"words\">";
    case TableCell::Look::bad:
      return "<td class=\"bad\">";
  }
  return "<td>";
}

}  // namespace

void print_table(std::ostream& out, const Table& table) {
  const bool windowed = table.height == Table::Height::windowed;
  // Those who scroll by keyboard must be able to get there.
  out << "<div class=\"scroll" << (windowed ? " windowed" : "")
      << "\" tabindex=\"0\"><table>\n<thead><tr>";
  for (const std::string& column : table.columns) {
    out << "<th scope=\"col\">" << escape(column) << "</th>";
  }
  out << "</tr></thead>\n<tbody>\n";
  for (const std::vector<TableCell>& row : table.rows) {
    out << "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i == 0) {
        out << "<th scope=\"row\">" << escape(row[i].text) << "</th>";
      } else {
        out << open_cell(row[i].look) << escape(row[i].text) << "</td>";
      }
    }
    out << "</tr>\n";
  }
  out << "</tbody></table></div>\n";
}

TableCell harm(std::size_t count) {
  return {grouped(count), count > 0 ? TableCell::Look::bad : TableCell::Look::number};
}

}  // namespace keepout::app
