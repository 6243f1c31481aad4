// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <ostream>
#include <utility>

#include "bench/json_parts.h"
#include "bench/speed/speed_record.h"
#include "number_text.h"

namespace keepout::app {
namespace {

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

Json json_of(const MeasuredSide& side) {
  return {{"name", side.name}, {"us", json_of(side.us)}, {"batch", side.batch}};
}

Json json_of(const SpeedRow& row) {
  Json sides = Json::array();
  for (const MeasuredSide& side : row.sides) sides.push_back(json_of(side));
  const bool least = row.demand.sense == Demand::Sense::at_least;
  return {{"work", row.work},
          {"compared", row.compared},
          {"demanded", {{least ? "at_least" : "at_most", row.demand.value}}},
          {"unit", row.unit},
          {"figure", or_null(row.figure)},
          {"met", row.figure ? Json(row.is_met()) : Json(nullptr)},
          {"sides", std::move(sides)},
          {"remark", row.remark}};
}

Json json_of(const QueryFigures& figures) {
  return {{"index", figures.index},
          {"radius", figures.radius},
          {"found_mean", figures.found_mean},
          {"candidates_us", json_of(figures.candidates)},
          {"answer_us", json_of(figures.answer)},
          {"lean_answer_us", json_of(figures.lean_answer)}};
}

Json json_of(const TimeHistogram& histogram) {
  Json bins = Json::array();
  for (std::size_t bin = 0; bin < TimeHistogram::bins; ++bin) {
    if (histogram.count(bin) == 0) continue;
    bins.push_back(Json::array({TimeHistogram::beginning_of(bin), histogram.count(bin)}));
  }
  Json shares = Json::object();
  for (const auto& [name, share] :
       {std::pair{"p50", 0.5}, std::pair{"p99", 0.99}, std::pair{"p999", 0.999},
        std::pair{"p9999", 0.9999}, std::pair{"p99999", 0.99999}}) {
    shares[name] = or_null(histogram.percentile(share));
  }
  return {{"total", histogram.total()},
          {"longest_ns", histogram.longest()},
          {"at_most_ns", std::move(shares)},
          {"bins", std::move(bins)}};
}

template <class T>
Json list_of(const std::vector<T>& items) {
  Json list = Json::array();
  for (const T& item : items) list.push_back(json_of(item));
  return list;
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

void write_json(std::ostream& out, const SpeedRecord& record) {
  const Json all = {
      {"date", record.date},
      {"command", record.command},
      {"complete", record.complete},
      {"seed", record.seed},
      {"machine", json_of(record.machine)},
      {"mesh", record.mesh},
      {"rows", list_of(record.rows)},
      {"queries", list_of(record.queries)},
      {"histogram", record.histogram ? Json{{"steps", json_of(record.histogram->steps)},
                                            {"nothing", json_of(record.histogram->nothing)}}
                                     : Json(nullptr)}};
  out << all.dump(2) << '\n';
}

}  // namespace keepout::app
