// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <ostream>
#include <utility>

#include "bench/speed/speed.h"
#include "record/json_parts.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

/// Returns the unit as text after a number.
std::string unit_of(const SpeedRow& row) {
  return row.unit == "x" || row.unit.empty() ? row.unit : " " + row.unit;
}

std::string name_of(const SpeedRow& row) { return row.work + ": " + row.compared; }

/// Returns text such as "at least 38x" or "at most 45 bytes".
std::string demand_text(const SpeedRow& row) {
  const bool least = row.demand.contains("at_least");
  return (least ? "at least " : "at most ") + trimmed(row.demand.front().get<double>()) +
         unit_of(row);
}

/// Returns text such as "41.2x"; "-" if it was not measured.
std::string figure_of(const SpeedRow& row) {
  if (!row.figure) return "-";
  return (row.unit == "x" ? rounded(*row.figure) : trimmed(*row.figure, 3)) + unit_of(row);
}

/// Returns text such as "5.13 / 7.90 / 12.1" with a unit: median, p99 and p99.9, as far as there
/// are enough samples.
std::string times_text(const Json& us) {
  // One unit for all three times, from seconds down to nanoseconds.
  const bool long_ones = us["p50"] >= 1e4;
  std::string text;
  for (const char* percentile : {"p50", "p99", "p999"}) {
    if (us[percentile].is_null()) continue;
    text += (text.empty() ? "" : " / ") +
            rounded((long_ones ? 1e-3 : 1.0) * us[percentile].get<double>());
  }
  return text + (long_ones ? " ms" : " us");
}

/// Returns a mean of counts as text: 0.130, 26.2, 10,151.
std::string mean_text(const Json& json) {
  const double mean = json.get<double>();
  return !(mean >= 1e3) ? rounded(mean) : grouped(static_cast<std::size_t>(std::llround(mean)));
}

const Columns<MeasuredSide> side_columns{{"name", &MeasuredSide::name, "", -32},
                                         {"us", &MeasuredSide::us, "", 1, times_text},
                                         {"batch", &MeasuredSide::batch}};

Json met(const SpeedRow& row) { return row.figure ? Json(row.is_met()) : Json(); }

const Columns<SpeedRow> row_columns{
    {"work", &SpeedRow::work},
    {"compared", &SpeedRow::compared},
    {"", name_of, "", -100},
    {"demanded", &SpeedRow::demand},
    {"", demand_text, "demanded", 18},
    {"unit", &SpeedRow::unit},
    {"figure", &SpeedRow::figure},
    {"", figure_of, "measured", 12},
    {"met", met},
    {"sides", [](const SpeedRow& row) { return json_of(side_columns, row.sides); }},
    {"remark", &SpeedRow::remark}};

template <MeasuredSide QueryFigures::*side>
Json times(const QueryFigures& figures) {
  return (figures.*side).us;
}

const Columns<QueryFigures> query_columns{
    {"index", &QueryFigures::index},
    {"radius", &QueryFigures::radius, "r mm", 6,
     [](const Json& radius) { return trimmed(radius.get<double>()); }},
    {"", &QueryFigures::index, "index", -16},
    {"found_mean", &QueryFigures::found_mean, "found", 8, mean_text},
    {"candidates_us", times<&QueryFigures::candidates>, "candidates", -24, times_text},
    {"answer_us", times<&QueryFigures::answer>, "answer", -24, times_text},
    {"lean_answer_us", times<&QueryFigures::lean_answer>, "by a lean exact test", -24, times_text}};

void list(std::ostream& out, const std::string& title, const std::vector<std::string>& names) {
  if (names.empty()) return;
  out << title << '\n';
  for (const std::string& name : names) out << "  " << name << '\n';
}

Json json_of(const TimeHistogram& histogram) {
  Json bins = Json::array();
  for (std::size_t bin = 0; bin < TimeHistogram::bins; ++bin) {
    if (histogram.count(bin) == 0) continue;
    bins.push_back(Json::array({TimeHistogram::beginning_of(bin), histogram.count(bin)}));
  }
  return {{"total", histogram.total()},
          {"longest_ns", histogram.longest()},
          {"at_most_ns",
           {{"p50", histogram.percentile(0.5)},
            {"p99", histogram.percentile(0.99)},
            {"p999", histogram.percentile(0.999)},
            {"p9999", histogram.percentile(0.9999)},
            {"p99999", histogram.percentile(0.99999)}}},
          {"bins", std::move(bins)}};
}

/// Returns a sentence with the number of demands that are met.
std::string headline(const SpeedRun& run) {
  std::size_t met = 0, missing = 0;
  for (const SpeedRow& row : run.rows) {
    met += row.is_met() ? 1 : 0;
    missing += row.figure ? 0 : 1;
  }
  return grouped(met) + " of " + counted(run.rows.size(), "demand") + " met, " +
         grouped(run.rows.size() - met - missing) + " fall short, " + grouped(missing) +
         " not measured" + (run.complete ? "." : "; interrupted, so only a part of the table.");
}

}  // namespace

void SpeedRun::add(SpeedRow row) {
  progress.interrupt();
  print_row(out, row_columns, row);
  out << "  " << (row.figure && !row.is_met() ? "short" : row.figure ? "" : "not measured") << '\n';
  for (const MeasuredSide& side : row.sides) {
    out << "    ";
    print_row(out, side_columns, side);
    out << (side.batch > 1 ? " *\n" : "\n");
  }
  if (!row.remark.empty()) out << "    " << row.remark << '\n';
  out.flush();
  if (row.is_wrong) wrong.push_back(name_of(row));
  rows.push_back(std::move(row));
}

void SpeedRun::set_histogram(const TimeHistogram& steps, const TimeHistogram& nothing) {
  const auto within = [&](double share) {
    return time_text(1e-3 * steps.percentile(share).value_or(0.0));
  };
  const auto longest = [](const TimeHistogram& times) {
    return time_text(1e-3 * static_cast<double>(times.longest()));
  };
  histogram = {{"steps", json_of(steps)}, {"nothing", json_of(nothing)}};
  histogram_words =
      grouped(steps.total()) + " certified steps in contact: 99 % within " + within(0.99) +
      ", 99.9 % within " + within(0.999) + ", 99.999 % within " + within(0.99999) +
      ", the longest " + longest(steps) +
      ". The empty loop waits as often and as long as the median step and does nothing: its "
      "longest took " +
      longest(nothing) + ", which is the machine's doing.";
}

void print_head(const SpeedRun& run) {
  run.out << "The table of ratios, on " << run.mesh << " unless said; one core unless said.\n"
          << "Below each row what it is made of: median / p99 / p99.9. A median below 0.2 us, "
             "marked *,\n"
          << "is that of batches; reading the clock, which all other times include, takes "
          << rounded(run.machine.clock_ns, 2) << " ns.\n\n";
  print_headings(run.out, row_columns);
  run.out << '\n';
}

void print_summary(const SpeedRun& run) {
  std::ostream& out = run.out;
  if (!run.queries.empty()) {
    out << "\nSphere queries at random places, us: median / p99 / p99.9\n";
    print_rows(out, query_columns, run.queries);
  }
  std::vector<std::string> short_ones, missing;
  for (const SpeedRow& row : run.rows) {
    if (!row.figure) {
      missing.push_back(name_of(row) + ": " + row.remark);
    } else if (!row.is_met()) {
      short_ones.push_back(name_of(row) + ": " + figure_of(row) + ", demanded " + demand_text(row));
    }
  }
  if (!run.histogram.is_null()) out << '\n' << for_terminal(run.histogram_words) << '\n';
  out << '\n' << headline(run) << '\n';
  list(out, "Short of what is demanded:", short_ones);
  list(out, "Not measured:", missing);
}

Json record_of(const SpeedRun& run) {
  Json all = new_record(
      {.kind = "speed",
       .date = run.date,
       .command = run.options.command,
       .complete = run.complete,
       .subject = "The table of ratios, of " + run.mesh + " unless said, on one core unless said",
       .headline = headline(run),
       .machine = run.machine,
       .settings = {{"seed", std::to_string(run.options.seed)}}});
  if (!run.histogram.is_null()) all["account"].push_back(run.histogram_words);
  all["mesh"] = run.mesh;
  all["seed"] = run.options.seed;
  all["rows"] = json_of(row_columns, run.rows);
  all["queries"] = json_of(query_columns, run.queries);
  all["histogram"] = run.histogram;
  return all;
}

}  // namespace keepout::app
