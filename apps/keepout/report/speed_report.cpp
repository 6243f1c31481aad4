// SPDX-License-Identifier: BSD-3-Clause
#include "report/speed_report.h"

#include <algorithm>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "bench/speed/speed_record.h"
#include "number_text.h"
#include "report/benchmark_style.h"
#include "report/histogram_plots.h"
#include "report/machine_facts.h"
#include "report/page.h"
#include "report/table.h"
#include "report/text.h"

namespace keepout::app {
namespace {

using Look = TableCell::Look;

/// The names of rows are sentences here, and break.
constexpr std::string_view ratio_style = R"css(
.ratios th[scope=row] { white-space: normal; min-width: 17em; font-weight: 550; }
.ratios td.words { min-width: 19em; font-size: 13.5px; font-variant-numeric: tabular-nums; }
)css";

std::string headline(const SpeedRecord& record) {
  const auto met = static_cast<std::size_t>(
      std::ranges::count_if(record.rows, [](const SpeedRow& row) { return row.is_met(); }));
  const auto measured = static_cast<std::size_t>(std::ranges::count_if(
      record.rows, [](const SpeedRow& row) { return row.figure.has_value(); }));
  std::string text = grouped(met) + " of " + counted(record.rows.size(), "demand") + " met";
  if (measured < record.rows.size()) {
    text += ", " + grouped(record.rows.size() - measured) + " not measured";
  }
  return text + (record.complete ? "." : "; interrupted, so only a part of the table.");
}

std::string sides_text(const SpeedRow& row) {
  std::string text;
  for (const MeasuredSide& side : row.sides) {
    text += (text.empty() ? "" : "; ") + side.name + " " + side_text(side) +
            (side.batch > 1 ? " *" : "");
  }
  if (!row.remark.empty()) text += (text.empty() ? "" : "; ") + row.remark;
  return text;
}

void print_ratios(std::ostream& out, const SpeedRecord& record) {
  open_section(out, "What is demanded, and what was measured",
               "Of " + record.mesh +
                   " unless said, on one core unless said. Beside each figure what it is made of: "
                   "median / p99 / p99.9. A median below 0.2 us, marked *, is that of batches; "
                   "reading the clock, which all other times include, takes " +
                   rounded(record.machine.clock_ns, 2) + " ns.");
  Table table{.columns = {"Work", "Demanded", "Measured", "Made of"}, .rows = {}};
  for (const SpeedRow& row : record.rows) {
    const Look look = row.is_met() ? Look::number : Look::bad;
    const std::string figure = row.figure ? figure_text(row) : verdict_text(row);
    table.rows.push_back({{row.work + ": " + row.compared, Look::name},
                          {demand_text(row)},
                          {row.figure && !row.is_met() ? figure + ", short" : figure, look},
                          {sides_text(row), Look::words}});
  }
  out << "<div class=\"ratios\">\n";
  print_table(out, table);
  out << "</div>\n";
}

void print_panel(std::ostream& out, const std::string& name, const std::string& about,
                 const std::string& picture) {
  out << "<figure class=\"measured\"><figcaption><span class=\"name\">" << escape(name)
      << "</span><br><span class=\"about\">" << escape(about) << "</span></figcaption>" << picture
      << "</figure>\n";
}

void print_histogram(std::ostream& out, const SpeedRecord& record) {
  if (!record.histogram) return;
  const StepHistogram& histogram = *record.histogram;
  const auto at = [](const TimeHistogram& times, double share) {
    return time_text(1e-3 * times.percentile(share).value_or(0.0));
  };
  open_section(out, "Cycle after cycle",
               grouped(histogram.steps.total()) + " certified steps in contact: 99 % within " +
                   at(histogram.steps, 0.99) + ", 99.9 % within " + at(histogram.steps, 0.999) +
                   ", 99.999 % within " + at(histogram.steps, 0.99999) + ", the longest " +
                   time_text(1e-3 * static_cast<double>(histogram.steps.longest())) +
                   ". The empty loop waits as often and as long as the median step and does "
                   "nothing: its longest took " +
                   time_text(1e-3 * static_cast<double>(histogram.nothing.longest())) +
                   ", which is the machine's doing.");
  out << "<div class=\"panels wide charts\" style=\"--columns:2\">\n";
  print_panel(out, "How many took how long", "Eight bins to each doubling.",
              counts_plot(histogram));
  print_panel(out, "How many took longer", "Of a million cycles, those that lie to the right.",
              tail_plot(histogram));
  out << "</div>\n";
}

void print_queries_section(std::ostream& out, const SpeedRecord& record) {
  if (record.queries.empty()) return;
  open_section(
      out, "Sphere queries at random places, every index",
      "In us: median / p99 / p99.9. Candidates: what the index does alone. Answer: the "
      "triangles within the ball, by the engine's kernel for each candidate where the index "
      "does not know by itself; beside it by the least code that decides the same. All "
      "answers are the same.");
  Table table{.columns = {"Index", "r mm", "Triangles found", "Candidates", "Answer",
                          "By a lean exact test"},
              .rows = {}};
  for (const QueryFigures& figures : record.queries) {
    table.rows.push_back({{figures.index, Look::name},
                          {trimmed(figures.radius)},
                          {mean_text(figures.found_mean)},
                          {side_text({.us = figures.candidates})},
                          {side_text({.us = figures.answer})},
                          {side_text({.us = figures.lean_answer})}});
  }
  print_table(out, table);
}

}  // namespace

void print_speed_report(std::ostream& out, const SpeedRecord& record) {
  open_page(out, "keepout bench --speed", std::string(benchmark_style) + std::string(ratio_style));
  out << "<p class=\"eyebrow\">The table of ratios; <strong>" << escape(record.machine.processor)
      << "</strong>, " << escape(record.date) << "</p>\n<h1>" << escape(headline(record))
      << "</h1>\n";
  print_ratios(out, record);
  print_histogram(out, record);
  print_queries_section(out, record);
  out << "<h2>The machine</h2>\n<div class=\"panels wide\" style=\"--columns:1\">\n<figure>";
  print_machine_facts(out, record.machine, record.date, record.command, record.seed);
  out << "</figure>\n</div>\n";
  close_page(out);
}

}  // namespace keepout::app
