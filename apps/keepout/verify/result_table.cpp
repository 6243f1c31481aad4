// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <numeric>
#include <ostream>

#include "result.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

std::uint64_t count(const Json& counts, const char* name) {
  return counts.at(name).get<std::uint64_t>();
}

/// "-" where there is none.
std::string number(const char* format, const Json& value) {
  return value.is_null() ? "-" : formatted(format, value.get<double>());
}

/// The shards that are not there.
std::vector<std::uint64_t> missing_shards(const Json& result) {
  std::vector<std::uint64_t> missing(count(result, "shard_count"));
  std::iota(missing.begin(), missing.end(), 1);
  for (const Json& shard : result.at("shards")) std::erase(missing, count(shard, "index"));
  return missing;
}

std::uint64_t sum(const Json& counts) {
  std::uint64_t total = 0;
  for (const Json& part : counts) total += part.get<std::uint64_t>();
  return total;
}

std::string grouped_count(const Json& value) { return grouped(value.get<std::uint64_t>()); }

/// What stands at some place in the tally of a mesh: a count, unless it is told of otherwise.
Column<Json> column(const char* place, const char* heading, int width,
                    std::string (*text)(const Json&) = &grouped_count) {
  return {"", [at = Json::json_pointer(place)](const Json& mesh) { return mesh.at(at); }, heading,
          width, text};
}

Columns<Json> columns() {
  const auto contact = [](const Json& mesh) -> Json {
    const auto steps = mesh.at("steps").get<double>();
    return steps == 0.0 ? 0.0 : 100.0 * mesh.at("statuses").at("limited").get<double>() / steps;
  };
  const auto other = [](const Json& mesh) -> Json {
    std::uint64_t others = count(mesh, "steps");
    for (const char* known : {"free", "limited", "recovering", "fallback", "unsolved"}) {
      others -= count(mesh.at("statuses"), known);
    }
    return grouped(others);
  };
  const auto broken = [](const Json& mesh) -> Json {
    const Json& breaches = mesh.at("breaches");
    return grouped(sum(breaches) - count(breaches, "penetration"));
  };
  const auto triangles = [](const Json& mesh) -> Json {
    const std::uint64_t known = mesh.value("triangles", std::uint64_t{0});
    return known == 0 ? "-" : grouped(known);
  };
  return {
      column("/mesh", "mesh", -16, &plain),
      {"", triangles, "triangles", 9},
      column("/trajectories", "traject.", 8),
      column("/steps", "steps", 12),
      {"", contact, "contact", 7, [](const Json& v) { return number("%.1f%%", v); }},
      column("/statuses/free", "free", 12),
      column("/statuses/limited", "limited", 12),
      column("/statuses/recovering", "recovering", 11),
      column("/led_out", "led out", 9),
      column("/statuses/fallback", "fallback", 9),
      column("/statuses/unsolved", "unsolved", 9),
      {"", other, "other", 9},
      column("/breaches/penetration", "crossed", 7),
      {"", broken, "broken", 7},
      column("/least_beyond_margin_in_tau", "least/tau", 8,
             [](const Json& v) { return number("%.3f", v); }),
      column("/least_beyond_margin", "least", 10, [](const Json& v) { return number("%.2e", v); }),
      column("/seconds", "seconds", 8, [](const Json& v) { return number("%.1f", v); })};
}

/// An incident in a few lines, but without Jacobian and rows.
std::string text(const Json& incident) {
  constexpr std::array<std::string_view, 6> first_of_a_line{"start",   "radius", "tip",
                                                            "desired", "motion", "distance"};
  constexpr std::array<std::string_view, 3> left_out{"jacobian", "row_matrix", "row_bounds"};
  std::string text;
  for (const auto& [key, value] : incident.items()) {
    if (std::ranges::find(left_out, key) != left_out.end()) continue;
    const bool begins_line = std::ranges::find(first_of_a_line, key) != first_of_a_line.end();
    text += begins_line ? "\n  " : text.empty() ? "" : " ";
    text += key + ' ' + (value.is_string() ? value.get<std::string>() : value.dump());
  }
  return text + '\n';
}

}  // namespace

std::uint64_t breach_count(const Json& result) { return sum(result.at("total").at("breaches")); }

bool is_complete(const Json& result) {
  return missing_shards(result).empty() &&
         std::ranges::all_of(result.at("shards").get<std::vector<Json>>(),
                             [](const Json& shard) { return shard.value("complete", true); });
}

std::string headline(const Json& result) {
  const std::uint64_t broken = breach_count(result);
  return (broken == 0 ? "No breach in " : counted(broken, "breach") + " in ") +
         counted(count(result.at("total"), "steps"), "step") + ".";
}

std::vector<std::string> account(const Json& result) {
  std::vector<std::string> told;
  const Json& breaches = result.at("breaches");
  if (breach_count(result) > breaches.size()) {
    told.push_back("Of the breaches " + grouped(breaches.size()) + " are kept.");
  }
  if (!is_complete(result)) {
    told.push_back("Incomplete: " + grouped(count(result.at("total"), "steps")) +
                   " of the campaign's " + counted(count(result, "steps"), "step") + " are done.");
  }
  const std::string shards = "/" + result.at("shard_count").dump();
  for (const std::uint64_t shard : missing_shards(result)) {
    told.push_back("Missing: shard " + std::to_string(shard) + shards + ".");
  }
  for (const Json& mesh : result.at("missing")) {
    told.push_back("Missing: " + mesh.get<std::string>() + ".");
  }
  return told;
}

void print(std::ostream& out, const Json& result) {
  auto rows = result.at("meshes").get<std::vector<Json>>();
  rows.push_back(result.at("total"));
  print_rows(out, columns(), rows);
  out << "contact: share of limited steps. led out: of the recovering ones, those from the\n"
         "forbidden side, which may cross. other: steps without a motion. crossed, broken: "
         "breaches\n"
         "of the theorem. least: smallest distance of any way, less tool radius and margin, in\n"
         "tau and as it is.\n";
  const std::string shards = "/" + result.at("shard_count").dump();
  for (const Json& shard : result.at("shards")) {
    out << "shard " << shard.at("index") << shards << ": " << number("%.1f", shard.at("seconds"))
        << " s on " << shard.at("machine").get<std::string>()
        << (shard.value("complete", true) ? "" : ", interrupted") << '\n';
  }
  constexpr std::size_t shown = 5;
  const Json& breaches = result.at("breaches");
  for (std::size_t i = 0; i < std::min(shown, breaches.size()); ++i) out << text(breaches[i]);
  out << headline(result) << '\n';
  for (const std::string& text : account(result)) out << text << '\n';
}

}  // namespace keepout::app
