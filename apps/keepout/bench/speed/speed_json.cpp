// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <ostream>
#include <utility>

#include "bench/json_parts.h"
#include "bench/speed/speed_files.h"

namespace keepout::app {
namespace {

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
