// SPDX-License-Identifier: BSD-3-Clause
#include "verify/result.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <sstream>

#include "keepout/simd_target.h"
#include "record/record.h"
#include "shared/machine.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

std::uint64_t count(const Json& counts, const char* name) {
  return counts.at(name).get<std::uint64_t>();
}

std::uint64_t sum(const Json& counts) {
  std::uint64_t sum = 0;
  for (const Json& part : counts) sum += part.get<std::uint64_t>();
  return sum;
}

/// Returns a column of the values at a place of a row, by default with the text of a count.
Column<Json> column(const char* place, const char* heading, int width,
                    std::string (*text)(const Json&) = &count_text) {
  return {"", [at = Json::json_pointer(place)](const Json& row) { return row.at(at); }, heading,
          width, text};
}

Columns<Json> tip_columns() {
  const auto contact = [](const Json& row) {
    const auto steps = std::max(row.at("steps").get<double>(), 1.0);
    return Json(100.0 * row.at("statuses").at("limited").get<double>() / steps);
  };
  const auto other = [](const Json& row) {
    std::uint64_t others = count(row, "steps");
    for (const char* known : {"free", "limited", "recovering", "truncated", "unsolved"}) {
      others -= count(row.at("statuses"), known);
    }
    return Json(others);
  };
  const auto broken = [](const Json& row) {
    return Json(sum(row.at("breaches")) - count(row.at("breaches"), "penetration"));
  };
  const auto triangles = [](const Json& row) {
    const auto known = row.value("triangles", std::uint64_t{0});
    return Json(known == 0 ? "-" : grouped(known));
  };
  return {column("/mesh", "mesh", -16, &plain),
          {"", triangles, "triangles", 9},
          column("/trajectories", "traject.", 8),
          column("/steps", "steps", 12),
          {"", contact, "contact", 7, &number_text<"%.1f%%">},
          column("/statuses/free", "free", 12),
          column("/statuses/limited", "limited", 12),
          column("/statuses/recovering", "recovering", 11),
          column("/led_out", "led out", 9),
          column("/statuses/truncated", "truncated", 9),
          column("/statuses/unsolved", "unsolved", 9),
          {"", other, "other", 9, &count_text},
          column("/breaches/penetration", "crossed", 7),
          {"", broken, "broken", 7, &count_text},
          column("/least_beyond_margin_in_tau", "least/tau", 8, &number_text<"%.3f">),
          column("/least_beyond_margin", "least", 10, &number_text<"%.2e">),
          column("/seconds", "seconds", 8, &number_text<"%.1f">)};
}

constexpr const char* tip_legend =
    R"(contact: fraction of limited steps. led out: recovering steps from the forbidden side,
which may cross. other: steps without a motion. crossed, broken: breaches of the
theorem. least: smallest distance of any motion minus the promised distance, in tau
and as a length.
)";

/// Returns the text of an incident in a few lines, without Jacobian and rows.
std::string text(const Json& incident) {
  constexpr std::array<std::string_view, 6> first_of_a_line{"start",   "radius", "tip",
                                                            "desired", "motion", "distance"};
  constexpr std::array<std::string_view, 3> left_out{"jacobian", "row_matrix", "row_bounds"};
  std::string text;
  for (const auto& [key, value] : incident.items()) {
    if (std::ranges::find(left_out, key) != left_out.end()) continue;
    const bool begins_line = std::ranges::find(first_of_a_line, key) != first_of_a_line.end();
    text += begins_line ? "\n  " : text.empty() ? "" : " ";
    text += key + ' ' + plain(value);
  }
  return text + '\n';
}

/// Returns the text of the rows and their total, the machines of the shards, and the first
/// breaches.
std::string table_of(const Json& record) {
  std::ostringstream out;
  auto rows = record.at("meshes").get<std::vector<Json>>();
  rows.push_back(record.at("total"));
  print_rows(out, tip_columns(), rows);
  out << tip_legend;
  for (const Json& shard : record.at("shards")) {
    out << "shard " << shard.at("index") << '/' << record.at("shard_count") << ": "
        << number_text<"%.1f">(shard.at("seconds")) << " s on "
        << shard.at("machine").get<std::string>()
        << (shard.value("complete", true) ? "" : ", interrupted") << '\n';
  }
  constexpr std::size_t shown = 5;
  const Json& breaches = record.at("breaches");
  for (std::size_t i = 0; i < std::min(shown, breaches.size()); ++i) out << text(breaches[i]);
  return out.str();
}

}  // namespace

void add(Json& sum, const Json& row) {
  for (const auto& [key, value] : row.items()) {
    Json& so_far = sum[key];
    if (value.is_object()) {
      add(so_far, value);
    } else if (so_far.is_null()) {
      so_far = value;
    } else if (key == "triangles" || key.starts_with("deepest")) {
      so_far = std::max(so_far, value);
    } else if (key.starts_with("least")) {
      if (!value.is_null()) so_far = std::min(so_far, value);
    } else if (value.is_number_float()) {
      so_far = so_far.get<double>() + value.get<double>();
    } else if (value.is_number()) {
      so_far = so_far.get<std::uint64_t>() + value.get<std::uint64_t>();
    }
  }
}

Json total_of(const Json& rows) {
  Json total{{"mesh", "total"}};
  for (const Json& row : rows) add(total, row);
  total.erase("triangles");
  return total;
}

void write_shard(Json& record, const Campaign& campaign, const Findings& findings) {
  const Json shard{{"index", campaign.shard.index},
                   {"seconds", findings.seconds},
                   {"machine", processor() + ", " + std::string(simd_target()) + ", " +
                                   KEEPOUT_COMPILER + ", " + KEEPOUT_BUILD_TYPE},
                   {"complete", findings.is_complete}};
  record.update({{"campaign_format", campaign_format},
                 {"seed", campaign.seed},
                 {"index", campaign.index},
                 {"shard_count", campaign.shard.count},
                 {"shards", Json::array({shard})},
                 {"missing", findings.missing}});
}

std::vector<std::uint64_t> missing_shards(const Json& record) {
  std::vector<std::uint64_t> missing(count(record, "shard_count"));
  std::iota(missing.begin(), missing.end(), 1);
  for (const Json& shard : record.at("shards")) std::erase(missing, count(shard, "index"));
  return missing;
}

bool are_whole(const Json& record) {
  const Json& shards = record.at("shards");
  return std::all_of(shards.begin(), shards.end(),
                     [](const Json& shard) { return shard.value("complete", true); });
}

void note_missing(Json& account, const Json& record) {
  for (const std::uint64_t shard : missing_shards(record)) {
    account.push_back("Missing: shard " + std::to_string(shard) + "/" +
                      record.at("shard_count").dump() + ".");
  }
}

std::string rate_bound(std::uint64_t trajectories) {
  const double bound = -std::expm1(std::log(0.05) / static_cast<double>(trajectories));
  return "With 95 % confidence, at most " + rounded(100 * bound, 2) +
         " % of such trajectories have a breach: " + counted(trajectories, "independent start") +
         ".";
}

CampaignResult finished(Json record) {
  Json& total = record["total"] = total_of(record.at("meshes"));
  const std::uint64_t steps = count(total, "steps");
  const std::uint64_t breaches = sum(total.at("breaches"));
  record["steps_done"] = steps;
  record["complete"] = missing_shards(record).empty() && are_whole(record);
  record["headline"] = (breaches == 0 ? "No breach" : counted(breaches, "breach")) + " in " +
                       counted(steps, "step") + ".";
  Json account = Json::array();
  const std::uint64_t trajectories = count(total, "trajectories");
  if (breaches == 0 && trajectories > 0) account.push_back(rate_bound(trajectories));
  if (breaches > record.at("breaches").size()) {
    account.push_back("The record contains " + grouped(record.at("breaches").size()) +
                      " of the breaches.");
  }
  if (!record["complete"].get<bool>()) {
    account.push_back("Incomplete: " + grouped(steps) + " of the campaign's " +
                      counted(count(record, "steps"), "step") + " are done.");
  }
  note_missing(account, record);
  for (const Json& mesh : record.at("missing")) {
    account.push_back("Missing: " + mesh.get<std::string>() + ".");
  }
  record["account"] = account;
  std::string table = table_of(record);
  const bool is_interrupted = !are_whole(record);
  return {std::move(record), std::move(table), breaches > 0, is_interrupted};
}

void CampaignResult::print(std::ostream& out) const {
  out << table << record.at("headline").get<std::string>() << '\n';
  for (const Json& text : record.at("account")) out << text.get<std::string>() << '\n';
}

CampaignResult result_of(const Campaign& campaign, const Findings& findings) {
  if (campaign.is_of_instruments()) return result_of_instruments(campaign, findings);
  Json meshes = Json::array();
  for (const Tally& t : findings.rows) {
    meshes.push_back({{"mesh", t.mesh},
                      {"triangles", t.triangles},
                      {"trajectories", t.starts},
                      {"steps", t.cycles},
                      {"tips", t.tips},
                      {"led_out", t.led_out},
                      {"statuses", json_of<Status>(t.statuses)},
                      {"breaches", json_of<oracle::Breach>(
                                       std::span(t.breaches).first(oracle::tip_breach_kinds))},
                      {"least_beyond_margin", or_null(t.least_beyond)},
                      {"least_beyond_margin_in_tau", or_null(t.least_in_tau)},
                      {"seconds", t.seconds}});
  }
  Json record = new_record({.kind = "verify",
                            .command = campaign.command,
                            .subject = "Adversarial closed-loop motion over " +
                                       counted(findings.rows.size(), "mesh") +
                                       ", each step judged by an exact oracle",
                            .settings = {{"seed", std::to_string(campaign.seed)},
                                         {"steps", grouped(campaign.steps)},
                                         {"index", campaign.index}}});
  write_shard(record, campaign, findings);
  record.update({{"steps", campaign.steps},
                 {"steps_done", 0},
                 {"meshes", meshes},
                 {"total", nullptr},
                 {"breaches", findings.breaches},
                 {"anomalies", findings.anomalies}});
  return finished(std::move(record));
}

}  // namespace keepout::app
