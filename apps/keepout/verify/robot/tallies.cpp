// SPDX-License-Identifier: BSD-3-Clause
// The rows of instruments in a record: read again, and added.

#include <algorithm>
#include <optional>

#include "keepout/error.h"
#include "verify/result.h"

namespace keepout::app {
namespace {

using oracle::Breach;

/// Each returns what two shards of a row are together.
constexpr auto sum = [](auto a, auto b) { return a + b; };
constexpr auto largest = [](auto a, auto b) { return std::max(a, b); };
constexpr auto smallest = [](auto a, auto b) { return std::min(a, b); };
/// Like smallest, but 0 stands for none.
constexpr auto first = [](std::uint64_t a, std::uint64_t b) {
  return a == 0 || b == 0 ? a + b : std::min(a, b);
};

/// A number of a row, by its name in a record.
template <class Number>
struct Member {
  const char* key;
  Number Tally::*place;
  Number (*together)(Number, Number);
};

constexpr Member<std::uint64_t> counts[] = {
    {"triangles", &Tally::triangles, largest}, {"starts", &Tally::starts, sum},
    {"cycles", &Tally::cycles, sum},           {"without_start", &Tally::startless, sum},
    {"in_mesh", &Tally::in_mesh, sum},         {"first_breach", &Tally::first_breach, first},
    {"blocked", &Tally::blocked, sum},         {"worse", &Tally::worse, sum},
    {"rounds_sum", &Tally::rounds, sum},       {"rounds_max", &Tally::most_rounds, largest},
    {"rows_sum", &Tally::rows, sum},           {"looks_max", &Tally::most_work_units, largest},
    {"excess_samples", &Tally::samples, sum},  {"useful", &Tally::useful, sum},
    {"movable", &Tally::movable, sum},         {"recoveries", &Tally::recoveries, sum},
    {"recovered", &Tally::recovered, sum},     {"recovery_cycles", &Tally::recovery_cycles, sum}};

constexpr Member<double> figures[] = {{"cycle_s", &Tally::period, largest},
                                      {"deepest_mm", &Tally::deepest, largest},
                                      {"least_beyond_mm", &Tally::least_beyond, smallest},
                                      {"least_beyond_tau", &Tally::least_in_tau, smallest},
                                      {"least_guide_tau", &Tally::least_guide_in_tau, smallest},
                                      {"excess_sum", &Tally::excess, sum},
                                      {"seconds", &Tally::seconds, sum}};

constexpr std::pair<const char*, Timing Tally::*> times[] = {{"step_us", &Tally::step},
                                                             {"contact_us", &Tally::contact},
                                                             {"free_us", &Tally::free},
                                                             {"point_us", &Tally::point}};

constexpr std::pair<const char*, Breach> breaches[] = {{"below", Breach::too_near},
                                                       {"limits_broken", Breach::limits_broken},
                                                       {"guides_left", Breach::guide_left},
                                                       {"strayed", Breach::strayed}};

std::uint64_t count(const Json& row, std::string_view key) {
  const Json& value = row.at(std::string(key));
  if (!value.is_number_unsigned()) throw Error(std::string(key) + " is not a count");
  return value.get<std::uint64_t>();
}

std::optional<double> percentile(const Json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

Tally tally_of(const Json& row) {
  Tally tally;
  tally.mesh = row.at("mesh").get<std::string>();
  tally.scenario = row.at("scenario").get<std::string>();
  tally.speed = row.at("speed").get<double>();
  for (const auto& [key, place, together] : counts) {
    tally.*place = row.at(key).is_null() ? 0 : count(row, key);
  }
  for (const auto& [key, place, together] : figures) {
    tally.*place = row.at(key).is_null() ? Tally::infinity : row.at(key).get<double>();
  }
  for (const auto& [key, place] : times) {
    const Json& us = row.at(key);
    tally.*place = {.p50 = us.at("p50").get<double>(),
                    .p99 = percentile(us.at("p99")),
                    .p999 = percentile(us.at("p999")),
                    .max = us.at("max").get<double>()};
  }
  for (const auto& [key, breach] : breaches) {
    tally.breaches[static_cast<std::size_t>(breach)] = count(row, key);
  }
  for (std::size_t i = 0; i < status_count; ++i) {
    tally.statuses[i] = count(row.at("statuses"), name(static_cast<Status>(i)));
  }
  return tally;
}

}  // namespace

std::vector<Tally> tallies_of(const Json& record) {
  std::vector<Tally> tallies;
  for (const Json& row : record.at("rows")) tallies.push_back(tally_of(row));
  return tallies;
}

void add(Tally& sum, const Tally& row) {
  for (const auto& [key, place, together] : counts) sum.*place = together(sum.*place, row.*place);
  for (const auto& [key, place, together] : figures) sum.*place = together(sum.*place, row.*place);
  for (const auto& [key, place] : times) {
    Timing& us = sum.*place;
    const Timing& other = row.*place;
    us = {.p50 = std::max(us.p50, other.p50),
          .p99 = std::max(us.p99, other.p99),  // an empty one is less than all
          .p999 = std::max(us.p999, other.p999),
          .max = std::max(us.max, other.max)};
  }
  std::ranges::transform(sum.breaches, row.breaches, sum.breaches.begin(), std::plus());
  std::ranges::transform(sum.statuses, row.statuses, sum.statuses.begin(), std::plus());
}

}  // namespace keepout::app
