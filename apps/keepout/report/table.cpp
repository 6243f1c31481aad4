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
    case TableCell::Look::name:
      return "<td class=\"name\">";
    case TableCell::Look::words:
      return "<td class=\"words\">";
    case TableCell::Look::bad:
      return "<td class=\"bad\">";
  }
  return "<td>";
}

/// A head stands where its column does.
bool to_left(const Table& table, std::size_t column) {
  if (table.rows.empty() || column >= table.rows.front().size()) return false;
  const TableCell::Look look = table.rows.front()[column].look;
  return look == TableCell::Look::name || look == TableCell::Look::words;
}

}  // namespace

void print_table(std::ostream& out, const Table& table) {
  const bool windowed = table.height == Table::Height::windowed;
  // Those who scroll by keyboard must be able to get there.
  out << "<div class=\"scroll" << (windowed ? " windowed" : "")
      << "\" tabindex=\"0\"><table>\n<thead><tr>";
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    out << "<th scope=\"col\"" << (to_left(table, i) ? " class=\"name\">" : ">")
        << escape(table.columns[i]) << "</th>";
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
