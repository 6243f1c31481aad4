// SPDX-License-Identifier: BSD-3-Clause
#include "result.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "keepout/error.h"
#include "keepout/simd_target.h"
#include "record/record.h"
#include "shared/machine.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

constexpr int campaign_format =
    3;  // raised whenever the trajectories of a seed, or tallies, change

template <class Enum, std::size_t n>
Json record_of(const std::array<std::uint64_t, n>& counts) {
  Json json = Json::object();
  for (std::size_t i = 0; i < n; ++i) json[std::string(name(static_cast<Enum>(i)))] = counts[i];
  return json;
}

/// JSON has no infinity.
Json or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json record_of(const Tally& t) {
  return {{"mesh", t.mesh},
          {"triangles", t.triangles},
          {"trajectories", t.trajectories},
          {"steps", t.steps},
          {"tips", t.tips},
          {"led_out", t.led_out},
          {"statuses", record_of<Status>(t.statuses)},
          {"breaches", record_of<Breach>(t.breaches)},
          {"least_beyond_margin", or_null(t.least)},
          {"least_beyond_margin_in_tau", or_null(t.least_in_tau)},
          {"seconds", t.seconds}};
}

/// Adds the tally of a mesh to another of the same, number by number; of what is least the lesser
/// counts.
void add(Json& sum, const Json& part) {
  for (const auto& [key, value] : part.items()) {
    Json& so_far = sum.at(key);
    if (value.is_object()) {
      add(so_far, value);
    } else if (key == "triangles") {
      so_far = std::max(so_far.get<std::uint64_t>(), value.get<std::uint64_t>());
    } else if (key.starts_with("least")) {
      if (so_far.is_null() || (!value.is_null() && value < so_far)) so_far = value;
    } else if (value.is_number_float()) {
      so_far = so_far.get<double>() + value.get<double>();
    } else if (value.is_number()) {
      so_far = so_far.get<std::uint64_t>() + value.get<std::uint64_t>();
    }
  }
}

/// Appends as many incidents as are kept of a kind.
void append(Json& to, const Json& from, std::size_t most) {
  for (const Json& incident : from) {
    if (to.size() < most) to.push_back(incident);
  }
}

/// What the two do not agree on though one campaign would; empty when they do.
std::string difference(const Json& a, const Json& b) {
  using Named = std::pair<const char*, const char*>;
  for (const auto& [key, what] : {Named{"version", "versions of keepout"}, Named{"seed", "seeds"},
                                  Named{"steps", "numbers of steps"}, Named{"index", "indices"},
                                  Named{"shard_count", "numbers of shards"}}) {
    if (a.at(key) != b.at(key)) return what;
  }
  const Json& some = a.at("meshes");
  const Json& others = b.at("meshes");
  const auto same_name = [](const Json& one, const Json& other) {
    return one.at("mesh") == other.at("mesh");
  };
  if (!std::ranges::equal(some, others, same_name)) return "meshes";
  for (std::size_t i = 0; i < some.size(); ++i) {
    const auto one = some[i].at("triangles").get<std::uint64_t>();
    const auto other = others[i].at("triangles").get<std::uint64_t>();
    if (one != other && one != 0 && other != 0) {
      return "numbers of triangles of " + some[i].at("mesh").get<std::string>();
    }
  }
  return {};
}

/// The shard that both have; 0 for none.
std::uint64_t common_shard(const Json& a, const Json& b) {
  for (const Json& one : a.at("shards")) {
    for (const Json& other : b.at("shards")) {
      if (one.at("index") == other.at("index")) return one.at("index").get<std::uint64_t>();
    }
  }
  return 0;
}

/// Says in words what has come out so far.
void tell(Json& result) {
  result.at("complete") = is_complete(result);
  result.at("headline") = headline(result);
  result.at("account") = account(result);
}

/// Precondition: the two are of one campaign.
void add_result(Json& sum, const Json& part) {
  for (std::size_t i = 0; i < part.at("meshes").size(); ++i) {
    add(sum.at("meshes")[i], part.at("meshes")[i]);
  }
  add(sum.at("total"), part.at("total"));
  append(sum.at("breaches"), part.at("breaches"), most_breaches);
  append(sum.at("anomalies"), part.at("anomalies"), most_anomalies);
  auto shards = sum.at("shards").get<std::vector<Json>>();
  for (const Json& shard : part.at("shards")) shards.push_back(shard);
  std::ranges::sort(shards, {}, [](const Json& s) { return s.at("index").get<std::uint64_t>(); });
  sum.at("shards") = shards;
  sum.at("steps_done") = sum.at("total").at("steps");
  tell(sum);
}

/// JSON has negative numbers and fractions, which get() would turn into counts, and which could
/// hide a breach in a sum.
bool is_count(const Json& value) {
  constexpr std::uint64_t most = std::uint64_t{1} << 53;
  return value.is_number_unsigned() && value.get<std::uint64_t>() <= most;
}

/// Of the numbers in a tally; none is missing, or print() would miss it.
bool are_possible(const Json& tally) {
  const auto entries = tally.items();
  return std::all_of(entries.begin(), entries.end(), [](const auto& entry) {
    const Json& value = entry.value();
    if (value.is_object()) return are_possible(value);
    if (entry.key() == "mesh") return value.is_string();
    if (entry.key() == "seconds") return value.is_number() && value.template get<double>() >= 0.0;
    if (entry.key().starts_with("least")) return value.is_null() || value.is_number();
    return is_count(value);
  });
}

/// Whether what a file says agrees with itself.
bool is_sound(const Json& result) {
  Json total = record_of(Tally{.mesh = "total"});
  for (const Json& mesh : result.at("meshes")) {
    if (!are_possible(mesh)) return false;
    add(total, mesh);
  }
  const auto agrees = [&](const char* key) {
    using Unordered = nlohmann::json;  // whatever order another program may have put them in
    return Unordered(total.at(key)) == Unordered(result.at("total").at(key));
  };
  const auto& shards = result.at("shards");
  std::vector<std::uint64_t> indices;
  for (const Json& shard : shards) {
    if (!is_count(shard.at("index"))) return false;
    indices.push_back(shard.at("index").get<std::uint64_t>());
  }
  std::ranges::sort(indices);
  const Json& count = result.at("shard_count");
  return are_possible(result.at("total")) && result.at("steps_done") == total.at("steps") &&
         std::ranges::all_of(
             std::array{"trajectories", "steps", "tips", "led_out", "statuses", "breaches"},
             agrees) &&
         is_count(count) && count <= Shard::most && !indices.empty() && indices.front() >= 1 &&
         indices.back() <= count.get<std::uint64_t>() &&
         std::ranges::adjacent_find(indices) == indices.end();
}

Json read(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw Error(path.string() + ": cannot be read; is it there?");
  const Error damaged(path.string() + ": is not a whole result of 'keepout verify --json'");
  try {
    Json result = Json::parse(file);
    if (!fault_of(result).empty() || result["keepout_record"] != "verify") throw damaged;
    const int written = result.at("campaign_format").get<int>();
    if (written != campaign_format) {
      throw Error(path.string() + ": written by another version of keepout verify (format " +
                  std::to_string(written) + ", not " + std::to_string(campaign_format) + ")");
    }
    if (!is_sound(result)) throw damaged;
    std::ostream nowhere(nullptr);
    print(nowhere, result);  // which misses what is not there
    return result;
  } catch (const Json::exception&) {
    throw damaged;
  }
}

}  // namespace

Json result_of(const CampaignRun& run, const Findings& findings) {
  const auto& [index, count] = run.settings.shard;
  const std::uint64_t all = trajectory_count(run.settings.steps);
  Json meshes = Json::array();
  Json total = record_of(Tally{.mesh = "total"});
  for (const Tally& tally : findings.meshes) {
    meshes.push_back(record_of(tally));
    add(total, meshes.back());
  }
  total.erase("triangles");
  // A signal that came after the last trajectory has interrupted nothing.
  const bool is_whole = total.at("trajectories") == (all + count - index) / count;
  const Json shard{{"index", index},
                   {"seconds", run.seconds},
                   {"machine", processor() + ", " + std::string(simd_target()) + ", " +
                                   KEEPOUT_COMPILER + ", " + KEEPOUT_BUILD_TYPE},
                   {"complete", is_whole}};
  Json record = new_record({.kind = "verify",
                            .command = run.command,
                            .subject = "Adversarial closed-loop motion over " +
                                       counted(findings.meshes.size(), "mesh") +
                                       ", each step judged by an exact oracle",
                            .settings = {{"seed", std::to_string(run.settings.seed)},
                                         {"steps", grouped(run.settings.steps)},
                                         {"index", run.index}}});
  record.update({{"campaign_format", campaign_format},
                 {"seed", run.settings.seed},
                 {"steps", run.settings.steps},
                 {"steps_done", total.at("steps")},
                 {"index", run.index},
                 {"shard_count", count},
                 {"shards", Json::array({shard})},
                 {"missing", run.missing},
                 {"meshes", meshes},
                 {"total", total},
                 {"breaches", findings.breaches},
                 {"anomalies", findings.anomalies}});
  tell(record);
  return record;
}

Json merged(const std::vector<std::filesystem::path>& files) {
  std::vector<Json> parts;
  for (const std::filesystem::path& file : files) {
    const Json part = read(file);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::string both = files[i].string() + " and " + file.string();
      if (const std::string what = difference(parts[i], part); !what.empty()) {
        throw Error(both + " are not of one campaign: their " + what + " differ");
      }
      if (const std::uint64_t shard = common_shard(parts[i], part); shard != 0) {
        throw Error(both + " both hold shard " + std::to_string(shard) + "/" +
                    part.at("shard_count").dump() + ": it would count twice");
      }
    }
    parts.push_back(part);
  }
  Json sum = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) add_result(sum, parts[i]);
  return sum;
}

}  // namespace keepout::app
