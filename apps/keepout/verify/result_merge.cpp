// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iterator>

#include "keepout/error.h"
#include "result.h"
#include "trajectory.h"

namespace keepout::app {
namespace {

/// What the two do not agree on though one campaign would; empty when they do.
std::string difference(const CampaignResult& a, const CampaignResult& b) {
  const auto differ = [](const std::string& what, const auto& one, const auto& other) {
    return one == other ? std::string() : what;
  };
  const auto meshes = [](const CampaignResult& result) {
    std::vector<std::string> names;
    for (const SceneResult& scene : result.findings.scenes) names.push_back(scene.mesh);
    return names;
  };
  for (const std::string& what :
       {differ("versions of keepout", a.version, b.version), differ("seeds", a.seed, b.seed),
        differ("numbers of steps", a.steps, b.steps), differ("indices", a.index, b.index),
        differ("numbers of shards", a.shard_count, b.shard_count),
        differ("meshes", meshes(a), meshes(b))}) {
    if (!what.empty()) return what;
  }
  for (std::size_t i = 0; i < a.findings.scenes.size(); ++i) {
    const SceneResult& one = a.findings.scenes[i];
    const SceneResult& other = b.findings.scenes[i];
    if (one.triangles != other.triangles && one.triangles != 0 && other.triangles != 0) {
      return "numbers of triangles of " + one.mesh;
    }
  }
  return {};
}

void append(std::vector<Incident>& to, const std::vector<Incident>& from, std::size_t most) {
  const std::size_t room = most - std::min(most, to.size());
  std::copy_n(from.begin(), std::min(room, from.size()), std::back_inserter(to));
}

void add(CampaignResult& sum, const CampaignResult& part) {
  for (std::size_t i = 0; i < sum.findings.scenes.size(); ++i) {
    SceneResult& scene = sum.findings.scenes[i];
    const SceneResult& other = part.findings.scenes[i];
    scene.triangles = std::max(scene.triangles, other.triangles);
    scene.tally += other.tally;
  }
  append(sum.findings.breaches, part.findings.breaches, most_breaches);
  append(sum.findings.anomalies, part.findings.anomalies, most_anomalies);
  sum.shards.insert(sum.shards.end(), part.shards.begin(), part.shards.end());
}

/// The shard that both have; 0 for none.
std::uint64_t common_shard(const CampaignResult& a, const CampaignResult& b) {
  for (const ShardRun& one : a.shards) {
    for (const ShardRun& other : b.shards) {
      if (one.index == other.index) return one.index;
    }
  }
  return 0;
}

}  // namespace

CampaignResult merged(const std::vector<std::filesystem::path>& files) {
  std::vector<CampaignResult> parts;
  for (const std::filesystem::path& file : files) {
    CampaignResult part = read_json(file);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::string both = files[i].string() + " and " + file.string();
      if (const std::string what = difference(parts[i], part); !what.empty()) {
        throw Error(both + " are not of one campaign: their " + what + " differ");
      }
      if (const std::uint64_t shard = common_shard(parts[i], part); shard != 0) {
        throw Error(both + " both hold shard " + std::to_string(shard) + "/" +
                    std::to_string(part.shard_count) + ": it would count twice");
      }
    }
    parts.push_back(std::move(part));
  }
  CampaignResult sum = std::move(parts.front());
  for (std::size_t i = 1; i < parts.size(); ++i) add(sum, parts[i]);
  std::sort(sum.shards.begin(), sum.shards.end(),
            [](const ShardRun& a, const ShardRun& b) { return a.index < b.index; });
  return sum;
}

std::vector<std::uint64_t> missing_shards(const CampaignResult& result) {
  std::vector<std::uint64_t> missing;
  for (std::uint64_t i = 1; i <= result.shard_count; ++i) {
    const bool is_there = std::any_of(result.shards.begin(), result.shards.end(),
                                      [i](const ShardRun& shard) { return shard.index == i; });
    if (!is_there) missing.push_back(i);
  }
  return missing;
}

bool is_complete(const CampaignResult& result) {
  return missing_shards(result).empty() &&
         std::all_of(result.shards.begin(), result.shards.end(),
                     [](const ShardRun& shard) { return shard.is_whole; });
}

}  // namespace keepout::app
