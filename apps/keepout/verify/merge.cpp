// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <fstream>
#include <map>
#include <tuple>
#include <utility>

#include "keepout/error.h"
#include "record/record.h"
#include "shared/machine.h"
#include "verify/result.h"

namespace keepout::app {
namespace {

bool is_of_instruments(const Json& record) { return record.at("keepout_record") == "verify_robot"; }

/// Returns the name of a property that differs although all shards of a campaign share it; empty if
/// there is no difference.
std::string difference(const Json& a, const Json& b) {
  using Named = std::pair<const char*, const char*>;
  for (const auto& [key, what] :
       {Named{"keepout_record", "kinds"}, Named{"version", "versions of keepout"},
        Named{"seed", "seeds"}, Named{"index", "indices"},
        Named{"shard_count", "numbers of shards"},
        Named{"settings", is_of_instruments(a) ? "settings" : "numbers of steps"}}) {
    if (a.at(key) != b.at(key)) return what;
  }
  if (is_of_instruments(a)) {
    // A shard that was stopped lacks its last rows.
    const Json &some = a.at("rows"), &others = b.at("rows");
    for (std::size_t i = 0; i < std::min(some.size(), others.size()); ++i) {
      for (const char* key : {"mesh", "triangles", "scenario", "speed"}) {
        if (some[i].at(key) != others[i].at(key)) return "rows";
      }
    }
    return {};
  }
  const Json &some = a.at("meshes"), &others = b.at("meshes");
  const auto same_name = [](const Json& one, const Json& other) {
    return one.at("mesh") == other.at("mesh");
  };
  if (!std::ranges::equal(some, others, same_name)) return "meshes";
  for (std::size_t i = 0; i < some.size(); ++i) {
    const auto [fewer, more] = std::minmax(some[i].at("triangles"), others[i].at("triangles"));
    if (fewer != more && fewer != 0) {
      return "numbers of triangles of " + some[i].at("mesh").get<std::string>();
    }
  }
  return {};
}

/// Returns true for a count. get() converts negative numbers and fractions into counts, which could
/// hide a breach in a sum.
bool is_count(const Json& value) {
  constexpr std::uint64_t most = std::uint64_t{1} << 53;
  return value.is_number_unsigned() && value.get<std::uint64_t>() <= most;
}

/// Returns true if each number of a row is possible.
bool are_possible(const Json& row) {
  const auto figures = row.items();
  return std::all_of(figures.begin(), figures.end(), [](const auto& figure) {
    const auto& [key, value] = std::pair(figure.key(), figure.value());
    if (value.is_object()) return are_possible(value);
    if (key == "mesh") return value.is_string();
    if (key == "seconds") return value.is_number() && value.template get<double>() >= 0.0;
    if (key.starts_with("least")) return value.is_null() || value.is_number();
    return is_count(value);
  });
}

/// Returns true if the numbers of a record agree with each other.
bool is_sound(const Json& record) {
  const Json& count = record.at("shard_count");
  const auto& shards = record.at("shards");
  if (!is_count(count) || count > Shard::most || shards.empty()) return false;
  std::vector<bool> is_there(count.get<std::size_t>());
  for (const Json& shard : shards) {
    const Json& index = shard.at("index");
    if (!is_count(index) || index < 1 || index > count || is_there[index.get<std::size_t>() - 1]) {
      return false;
    }
    is_there[index.get<std::size_t>() - 1] = true;
  }
  // Another program may have changed the order of members, and the sum of the seconds is rounded.
  if (is_of_instruments(record)) {
    const nlohmann::json again = finished(record, tallies_of(record)).record;
    return again == nlohmann::json(record);
  }
  const Json& meshes = record.at("meshes");
  if (!std::all_of(meshes.begin(), meshes.end(), &are_possible)) return false;
  nlohmann::json total = record.at("total"), sum = total_of(meshes);
  total["seconds"] = sum["seconds"];
  for (const char* which : {"breaches", "anomalies"}) {
    for (const Json& incident : record.at(which)) {
      if (!incident.at("mesh").is_string() || !is_count(incident.at("trajectory")) ||
          !is_count(incident.at("cycle"))) {
        return false;
      }
    }
  }
  return total == sum && record.at("steps_done") == sum["steps"];
}

Json read(const std::filesystem::path& path) {
  std::ifstream file = open_record(path);
  const Error damaged(path.string() + ": is not a whole result of 'keepout verify --json'");
  try {
    const Json record = Json::parse(file);
    if (!fault_of(record).empty()) throw damaged;
    if (record.at("keepout_record") != "verify" && !is_of_instruments(record)) throw damaged;
    const int written = record.value("campaign_format", 0);
    if (written != campaign_format) {
      throw Error(path.string() + ": written by another version of keepout verify (format " +
                  std::to_string(written) + ", not " + std::to_string(campaign_format) + ")");
    }
    if (!is_sound(record)) throw damaged;
    // Throws if a member is missing.
    return is_of_instruments(record) ? record : finished(record).record;
  } catch (const Json::exception&) {
    throw damaged;
  }
}

/// Returns the first incidents of all parts, in the order in which one machine finds them.
Json first_incidents(const std::vector<Json>& parts, const char* which, std::size_t most) {
  std::vector<Json> all;
  for (const Json& part : parts) all.insert(all.end(), part[which].begin(), part[which].end());
  const Json& meshes = parts.front()["meshes"];
  const auto place = [&](const Json& incident) {
    const auto same = [&](const Json& row) { return row["mesh"] == incident["mesh"]; };
    return std::tuple(std::ranges::find_if(meshes, same) - meshes.begin(),
                      incident["trajectory"].get<std::uint64_t>(),
                      incident["cycle"].get<std::uint64_t>());
  };
  std::ranges::stable_sort(all, {}, place);
  all.resize(std::min(all.size(), most));
  return all;
}

}  // namespace

CampaignResult merged(const std::vector<std::filesystem::path>& files, const std::string& command) {
  std::vector<Json> parts, shards;
  std::map<Json, std::filesystem::path> file_of;  // by the index of a shard
  Json common;                                    // the first part, with the triangles of all
  for (const std::filesystem::path& file : files) {
    const Json part = read(file);
    if (parts.empty()) common = part;
    if (const std::string what = difference(common, part); !what.empty()) {
      throw Error(files.front().string() + " and " + file.string() +
                  " are not of one campaign: their " + what + " differ");
    }
    for (std::size_t m = 0; !is_of_instruments(part) && m < part["meshes"].size(); ++m) {
      Json& triangles = common["meshes"][m]["triangles"];
      triangles = std::max(triangles, part["meshes"][m]["triangles"]);
    }
    for (const Json& shard : part.at("shards")) {
      const auto [other, is_new] = file_of.emplace(shard.at("index"), file);
      if (!is_new) {
        throw Error(other->second.string() + " and " + file.string() + " both contain shard " +
                    shard.at("index").dump() + "/" + part.at("shard_count").dump() +
                    ": it would count twice");
      }
      shards.push_back(shard);
    }
    parts.push_back(part);
  }
  Json sum = parts.front();
  std::ranges::sort(shards, {}, [](const Json& s) { return s.at("index").get<std::uint64_t>(); });
  sum["shards"] = shards;
  sum["command"] = command;
  sum["date"] = date_now();
  if (is_of_instruments(sum)) {
    std::vector<Tally> rows;
    for (const Json& part : parts) {
      const std::vector<Tally> more = tallies_of(part);
      for (std::size_t i = 0; i < more.size(); ++i) {
        if (i < rows.size()) {
          add(rows[i], more[i]);
        } else {
          rows.push_back(more[i]);
        }
      }
    }
    if (parts.size() > 1) sum["machine"] = nullptr;
    return finished(std::move(sum), rows);
  }
  for (std::size_t i = 1; i < parts.size(); ++i) {
    for (std::size_t m = 0; m < sum["meshes"].size(); ++m) {
      add(sum["meshes"][m], parts[i]["meshes"][m]);
    }
  }
  sum["breaches"] = first_incidents(parts, "breaches", most_breaches);
  sum["anomalies"] = first_incidents(parts, "anomalies", most_anomalies);
  return finished(std::move(sum));
}

}  // namespace keepout::app
