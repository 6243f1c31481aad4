// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <ostream>
#include <utility>

#include "bench/speed/speed_record.h"
#include "record/json_parts.h"
#include "record/record.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

/// As it stands behind a number.
std::string unit_of(const SpeedRow& row) {
  return row.unit == "x" || row.unit.empty() ? row.unit : " " + row.unit;
}

std::string name_of(const SpeedRow& row) { return row.work + ": " + row.compared; }

/// "at least 38x", "at most 45 bytes".
std::string demand_text(const SpeedRow& row) {
  const bool least = row.demand.sense == Demand::Sense::at_least;
  return (least ? "at least " : "at most ") + trimmed(row.demand.value) + unit_of(row);
}

/// "41.2x"; "-" where nothing was measured.
std::string figure_text(const SpeedRow& row) {
  if (!row.figure) return "-";
  return (row.unit == "x" ? rounded(*row.figure) : trimmed(*row.figure, 3)) + unit_of(row);
}

/// "met", "short" or "not measured".
std::string verdict_text(const SpeedRow& row) {
  if (!row.figure) return "not measured";
  return row.is_met() ? "met" : "short";
}

/// "5.13 / 7.90 / 12.1 us": median, p99 and p99.9, as far as there are enough samples.
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

std::string headline(const SpeedRecord& record) {
  const auto met = static_cast<std::size_t>(std::ranges::count_if(record.rows, &SpeedRow::is_met));
  const auto measured = static_cast<std::size_t>(std::ranges::count_if(
      record.rows, [](const SpeedRow& row) { return row.figure.has_value(); }));
  std::string text = grouped(met) + " of " + counted(record.rows.size(), "demand") + " met, " +
                     grouped(measured - met) + " fall short, " +
                     grouped(record.rows.size() - measured) + " not measured";
  return text + (record.complete ? "." : "; interrupted, so only a part of the table.");
}

std::string histogram_words(const SpeedRecord& record) {
  if (!record.histogram) return {};
  const auto& [steps, nothing] = *record.histogram;
  const auto within = [&](double share) {
    return time_text(1e-3 * steps.percentile(share).value_or(0.0));
  };
  const auto longest = [](const TimeHistogram& times) {
    return time_text(1e-3 * static_cast<double>(times.longest()));
  };
  return grouped(steps.total()) + " certified steps in contact: 99 % within " + within(0.99) +
         ", 99.9 % within " + within(0.999) + ", 99.999 % within " + within(0.99999) +
         ", the longest " + longest(steps) +
         ". The empty loop waits as often and as long as the median step and does nothing: its "
         "longest took " +
         longest(nothing) + ", which is the machine's doing.";
}

void print_summary(std::ostream& out, const SpeedRecord& record) {
  std::vector<std::string> short_ones, missing;
  for (const SpeedRow& row : record.rows) {
    if (!row.figure) {
      missing.push_back(name_of(row) + ": " + row.remark);
    } else if (!row.is_met()) {
      short_ones.push_back(name_of(row) + ": " + figure_text(row) + ", demanded " +
                           demand_text(row));
    }
  }
  if (record.histogram) out << '\n' << histogram_words(record) << '\n';
  out << '\n' << headline(record) << '\n';
  list(out, "Short of what is demanded:", short_ones);
  list(out, "Not measured:", missing);
}

Json record_of(const SpeedRecord& record) {
  Json all = new_record({.kind = "speed",
                         .date = record.date,
                         .command = record.command,
                         .complete = record.complete,
                         .subject = "The table of ratios, of " + record.mesh +
                                    " unless said, on one core unless said",
                         .headline = headline(record),
                         .machine = record.machine,
                         .settings = {{"seed", std::to_string(record.seed)}}});
  if (record.histogram) all["account"].push_back(histogram_words(record));
  all["mesh"] = record.mesh;
  all["seed"] = record.seed;
  all["rows"] = record.rows;
  all["queries"] = record.queries;
  all["histogram"] = record.histogram;
  return all;
}

}  // namespace keepout::app
