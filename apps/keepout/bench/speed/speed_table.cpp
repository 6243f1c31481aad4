// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <ostream>
#include <utility>

#include "bench/json_parts.h"
#include "bench/speed/speed_record.h"
#include "number_text.h"

namespace keepout::app {
namespace {

/// As it stands behind a number.
std::string unit_of(const SpeedRow& row) {
  return row.unit == "x" || row.unit.empty() ? row.unit : " " + row.unit;
}

std::string name_of(const SpeedRow& row) { return row.work + ": " + row.compared; }

void list(std::ostream& out, const std::string& title, const std::vector<std::string>& names) {
  if (names.empty()) return;
  out << title << '\n';
  for (const std::string& name : names) out << "  " << name << '\n';
}

}  // namespace

void to_json(Json& json, const MeasuredSide& side) {
  json = {{"name", side.name}, {"us", side.us}, {"batch", side.batch}};
}

void to_json(Json& json, const SpeedRow& row) {
  json = {
      {"work", row.work},
      {"compared", row.compared},
      {"demanded",
       {{row.demand.sense == Demand::Sense::at_least ? "at_least" : "at_most", row.demand.value}}},
      {"unit", row.unit},
      {"figure", row.figure},
      {"met", row.figure ? Json(row.is_met()) : Json(nullptr)},
      {"sides", row.sides},
      {"remark", row.remark}};
}

void to_json(Json& json, const QueryFigures& figures) {
  json = {{"index", figures.index},           {"radius", figures.radius},
          {"found_mean", figures.found_mean}, {"candidates_us", figures.candidates},
          {"answer_us", figures.answer},      {"lean_answer_us", figures.lean_answer}};
}

void to_json(Json& json, const TimeHistogram& histogram) {
  Json bins = Json::array();
  for (std::size_t bin = 0; bin < TimeHistogram::bins; ++bin) {
    if (histogram.count(bin) == 0) continue;
    bins.push_back(Json::array({TimeHistogram::beginning_of(bin), histogram.count(bin)}));
  }
  json = {{"total", histogram.total()},
          {"longest_ns", histogram.longest()},
          {"at_most_ns",
           {{"p50", histogram.percentile(0.5)},
            {"p99", histogram.percentile(0.99)},
            {"p999", histogram.percentile(0.999)},
            {"p9999", histogram.percentile(0.9999)},
            {"p99999", histogram.percentile(0.99999)}}},
          {"bins", std::move(bins)}};
}

void to_json(Json& json, const StepHistogram& histogram) {
  json = {{"steps", histogram.steps}, {"nothing", histogram.nothing}};
}

std::string demand_text(const SpeedRow& row) {
  const bool least = row.demand.sense == Demand::Sense::at_least;
  return (least ? "at least " : "at most ") + trimmed(row.demand.value) + unit_of(row);
}

std::string figure_text(const SpeedRow& row) {
  if (!row.figure) return "-";
  return (row.unit == "x" ? rounded(*row.figure) : trimmed(*row.figure, 3)) + unit_of(row);
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

void write_json(std::ostream& out, const SpeedRecord& record) {
  const Json all = {
      {"date", record.date}, {"command", record.command}, {"complete", record.complete},
      {"seed", record.seed}, {"machine", record.machine}, {"mesh", record.mesh},
      {"rows", record.rows}, {"queries", record.queries}, {"histogram", record.histogram}};
  out << all.dump(2) << '\n';
}

}  // namespace keepout::app
