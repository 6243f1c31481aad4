// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "bench/benchmark.h"
#include "bench/speed/time_histogram.h"

namespace keepout::app {

/// What a figure must come to.
struct Demand {
  enum class Sense : std::uint8_t { at_least, at_most };
  Sense sense = Sense::at_least;
  double value = 0.0;

  bool is_met_by(double figure) const {
    return sense == Sense::at_least ? figure >= value : figure <= value;
  }
};

/// One line of the table: a figure, what it must come to, and what it was made of.
struct SpeedRow {
  std::string work = {};      // what is done, on what
  std::string compared = {};  // "FCL's tree / wide_bvh"
  Demand demand = {};
  std::string unit = "x";             // of the figure; x: a ratio
  std::optional<double> figure = {};  // none: not measured, and the remark says why
  std::vector<MeasuredSide> sides = {};
  std::string remark = {};

  bool is_met() const { return figure && demand.is_met_by(*figure); }
};

/// What one index takes for a sphere query, for information.
struct QueryFigures {
  std::string index = {};
  double radius = 0.0;      // [mm]
  double found_mean = 0.0;  // triangles within the ball
  Timing candidates = {};   // [us]
  Timing answer = {};       // those of them within the ball, by the engine's kernel: ids only [us]
  Timing lean_answer = {};  // the same by the least code that decides the same [us]
};

/// The times of a great many steps, beside those of an empty loop.
struct StepHistogram {
  TimeHistogram steps;
  TimeHistogram nothing;
};

/// One run of the table.
struct SpeedRecord {
  std::string date = {};     // ISO 8601, UTC
  std::string command = {};  // that does it again
  std::uint64_t seed = 0;
  Machine machine = {};
  std::string mesh = {};  // on which all is measured that is not said to be on another
  std::vector<SpeedRow> rows = {};
  std::vector<QueryFigures> queries = {};
  std::optional<StepHistogram> histogram = {};
  bool complete = true;  // or interrupted: the rows are those that were measured until then
};

/// For a terminal, line by line as the rows come in.
void print_head(std::ostream& out, const SpeedRecord& record);
void print_row(std::ostream& out, const SpeedRow& row);

/// What every index takes for a query, and which rows fall short.
void print_queries(std::ostream& out, const SpeedRecord& record);
void print_summary(std::ostream& out, const SpeedRecord& record);

/// How many demands are met, in a sentence.
std::string headline(const SpeedRecord& record);

/// How long the steps of the histogram took; empty where there is none.
std::string histogram_words(const SpeedRecord& record);

/// The record of it: see docs/records.md.
Json record_of(const SpeedRecord& record);

}  // namespace keepout::app
