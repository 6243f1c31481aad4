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
constexpr auto added = [](auto a, auto b) { return a + b; };
constexpr auto largest = [](auto a, auto b) { return std::max(a, b); };
constexpr auto smallest = [](auto a, auto b) { return std::min(a, b); };
/// Like smallest, but 0 stands for none.
constexpr auto earliest = [](std::uint64_t a, std::uint64_t b) {
  return a == 0 || b == 0 ? a + b : std::min(a, b);
};

/// A number of a row, by its name in a record.
template <class Number>
struct RowMember {
  const char* key;
  Number Tally::*place;
  Number (*together)(Number, Number);
};

constexpr RowMember<std::uint64_t> row_counts[] = {
    {"triangles", &Tally::triangles, largest},
    {"starts", &Tally::starts, added},
    {"cycles", &Tally::cycles, added},
    {"without_start", &Tally::startless, added},
    {"in_mesh", &Tally::in_mesh, added},
    {"undecided", &Tally::undecided, added},
    {"first_breach", &Tally::first_breach, earliest},
    {"blocked", &Tally::blocked, added},
    {"worse", &Tally::worse, added},
    {"rounds_sum", &Tally::rounds, added},
    {"rounds_max", &Tally::most_rounds, largest},
    {"rows_sum", &Tally::rows, added},
    {"looks_max", &Tally::most_work_units, largest},
    {"excess_samples", &Tally::samples, added},
    {"useful", &Tally::useful, added},
    {"movable", &Tally::movable, added},
    {"recoveries", &Tally::recoveries, added},
    {"recovered", &Tally::recovered, added},
    {"recovery_cycles", &Tally::recovery_cycles, added}};

constexpr RowMember<double> row_figures[] = {
    {"cycle_s", &Tally::period, largest},
    {"deepest_mm", &Tally::deepest, largest},
    {"least_beyond_mm", &Tally::least_beyond, smallest},
    {"least_beyond_tau", &Tally::least_in_tau, smallest},
    {"least_guide_tau", &Tally::least_guide_in_tau, smallest},
    {"excess_sum", &Tally::excess, added},
    {"seconds", &Tally::seconds, added}};

constexpr std::pair<const char*, Timing Tally::*> row_times[] = {{"step_us", &Tally::step},
                                                                 {"contact_us", &Tally::contact},
                                                                 {"free_us", &Tally::free},
                                                                 {"point_us", &Tally::point}};

constexpr std::pair<const char*, Breach> row_breaches[] = {{"below", Breach::too_near},
                                                           {"limits_broken", Breach::limits_broken},
                                                           {"guides_left", Breach::guide_left},
                                                           {"strayed", Breach::strayed}};

std::uint64_t count_in(const Json& row, std::string_view key) {
  const Json& value = row.at(std::string(key));
  if (!value.is_number_unsigned()) throw Error(std::string(key) + " is not a count");
  return value.get<std::uint64_t>();
}

std::optional<double> percentile_in(const Json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

Tally tally_of(const Json& row) {
  Tally tally;
  tally.mesh = row.at("mesh").get<std::string>();
  tally.scenario = row.at("scenario").get<std::string>();
  tally.speed = row.at("speed").get<double>();
  for (const auto& [key, place, together] : row_counts) {
    tally.*place = row.at(key).is_null() ? 0 : count_in(row, key);
  }
  for (const auto& [key, place, together] : row_figures) {
    tally.*place = row.at(key).is_null() ? Tally::infinity : row.at(key).get<double>();
  }
  for (const auto& [key, place] : row_times) {
    const Json& us = row.at(key);
    tally.*place = {.p50 = us.at("p50").get<double>(),
                    .p99 = percentile_in(us.at("p99")),
                    .p999 = percentile_in(us.at("p999")),
                    .max = us.at("max").get<double>()};
  }
  for (const auto& [key, breach] : row_breaches) {
    tally.breaches[static_cast<std::size_t>(breach)] = count_in(row, key);
  }
  for (std::size_t i = 0; i < status_count; ++i) {
    tally.statuses[i] = count_in(row.at("statuses"), name(static_cast<Status>(i)));
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
  for (const auto& [key, place, together] : row_counts)
    sum.*place = together(sum.*place, row.*place);
  for (const auto& [key, place, together] : row_figures)
    sum.*place = together(sum.*place, row.*place);
  for (const auto& [key, place] : row_times) {
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
