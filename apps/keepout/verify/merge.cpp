// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <fstream>
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

/// Appends incidents up to the largest recorded number.
void append(Json& to, const Json& from, std::size_t most) {
  for (const Json& incident : from) {
    if (to.size() < most) to.push_back(incident);
  }
}

}  // namespace

CampaignResult merged(const std::vector<std::filesystem::path>& files, const std::string& command) {
  std::vector<Json> parts, shards;
  for (const std::filesystem::path& file : files) {
    const Json part = read(file);
    const auto same_index = [](const Json& one, const Json& other) {
      return one.at("index") == other.at("index");
    };
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::string both = files[i].string() + " and " + file.string();
      if (const std::string what = difference(parts[i], part); !what.empty()) {
        throw Error(both + " are not of one campaign: their " + what + " differ");
      }
      const Json& before = parts[i].at("shards");
      const auto twice = std::ranges::find_first_of(before, part.at("shards"), same_index);
      if (twice != before.end()) {
        throw Error(both + " both contain shard " + twice->at("index").dump() + "/" +
                    part.at("shard_count").dump() + ": it would count twice");
      }
    }
    for (const Json& shard : part.at("shards")) shards.push_back(shard);
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
    append(sum["breaches"], parts[i]["breaches"], most_breaches);
    append(sum["anomalies"], parts[i]["anomalies"], most_anomalies);
  }
  return finished(std::move(sum));
}

}  // namespace keepout::app
