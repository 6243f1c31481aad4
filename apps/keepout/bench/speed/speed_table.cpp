// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/speed_table.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ostream>

#include "number_text.h"

namespace keepout::app {
namespace {

template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 320> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string in_unit(double value, const std::string& unit, int digits) {
  if (unit == "x") return rounded(value, digits) + "x";
  return trimmed(value, digits) + (unit.empty() ? "" : " " + unit);
}

std::string name_of(const SpeedRow& row) { return row.work + ": " + row.compared; }

void list(std::ostream& out, const std::string& title, const std::vector<std::string>& names) {
  if (names.empty()) return;
  out << title << '\n';
  for (const std::string& name : names) out << "  " << name << '\n';
}

}  // namespace

std::string demand_text(const SpeedRow& row) {
  const bool least = row.demand.sense == Demand::Sense::at_least;
  const std::string unit = row.unit == "x" ? "x" : row.unit.empty() ? "" : " " + row.unit;
  return (least ? "at least " : "at most ") + trimmed(row.demand.value) + unit;
}

std::string figure_text(const SpeedRow& row) {
  return row.figure ? in_unit(*row.figure, row.unit, 3) : "-";
}

std::string verdict_text(const SpeedRow& row) {
  if (!row.figure) return "not measured";
  return row.is_met() ? "met" : "short";
}

std::string side_text(const MeasuredSide& side) {
  // From seconds down to nanoseconds, in one unit for all three.
  const bool long_ones = side.us.p50 >= 1e4;
  const double scale = long_ones ? 1e-3 : 1.0;
  std::string text = rounded(scale * side.us.p50);
  for (const std::optional<double>& tail : {side.us.p99, side.us.p999}) {
    if (tail) text += " / " + rounded(scale * *tail);
  }
  return text + (long_ones ? " ms" : " us");
}

void print_head(std::ostream& out, const SpeedRecord& record) {
  out << "The table of ratios, on " << record.mesh << " unless said; one core unless said.\n"
      << "Below each row what it is made of: median / p99 / p99.9. A median below 0.2 us, marked "
         "*,\n"
      << "is that of batches; reading the clock, which all other times include, takes "
      << rounded(record.machine.clock_ns, 2) << " ns.\n\n"
      << formatted("%-100s %18s %12s\n", "", "demanded", "measured");
}

void print_row(std::ostream& out, const SpeedRow& row) {
  out << formatted("%-100s %18s %12s  %s\n", name_of(row).c_str(), demand_text(row).c_str(),
                   figure_text(row).c_str(), row.is_met() ? "" : verdict_text(row).c_str());
  for (const MeasuredSide& side : row.sides) {
    out << formatted("    %-32s %s%s\n", side.name.c_str(), side_text(side).c_str(),
                     side.batch > 1 ? " *" : "");
  }
  if (!row.remark.empty()) out << "    " << row.remark << '\n';
}

void print_queries(std::ostream& out, const SpeedRecord& record) {
  if (record.queries.empty()) return;
  out << "\nSphere queries at random places, us: median / p99 / p99.9\n"
      << formatted("%6s  %-16s %8s  %-24s %-24s %-24s\n", "r mm", "index", "found", "candidates",
                   "answer", "by a lean exact test");
  for (const QueryFigures& figures : record.queries) {
    out << formatted("%6s  %-16s %8s  %-24s %-24s %-24s\n", trimmed(figures.radius).c_str(),
                     figures.index.c_str(), mean_text(figures.found_mean).c_str(),
                     side_text({.us = figures.candidates}).c_str(),
                     side_text({.us = figures.answer}).c_str(),
                     side_text({.us = figures.lean_answer}).c_str());
  }
}

void print_summary(std::ostream& out, const SpeedRecord& record) {
  std::vector<std::string> short_ones, missing;
  std::size_t met = 0;
  for (const SpeedRow& row : record.rows) {
    if (row.is_met()) {
      ++met;
    } else if (row.figure) {
      short_ones.push_back(name_of(row) + ": " + figure_text(row) + ", demanded " +
                           demand_text(row));
    } else {
      missing.push_back(name_of(row) + ": " + row.remark);
    }
  }
  if (!record.complete) out << "\nInterrupted: what had been measured until then is kept.\n";
  out << "\nOf " << counted(record.rows.size(), "demand") << ", " << grouped(met) << " are met, "
      << grouped(short_ones.size()) << " fall short, " << grouped(missing.size())
      << " were not measured.\n";
  list(out, "Short of what is demanded:", short_ones);
  list(out, "Not measured:", missing);
}

}  // namespace keepout::app
