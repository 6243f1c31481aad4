// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>

#include "keepout/error.h"
#include "result.h"

namespace keepout::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int format = 1;  // raised whenever the trajectories of a seed, or this file, change

Json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Vec3 to_vec3(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

// JSON has no infinity.
Json to_json(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
double to_double(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>();
}

/// One of an enumeration's names, which are its numbers from 0 on.
template <class Enum>
Enum from_name(const std::string& text, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (name(static_cast<Enum>(i)) == text) return static_cast<Enum>(i);
  }
  throw Error("unknown name '" + text + "'");
}

template <class Enum, std::size_t n>
Json counts_to_json(const std::array<std::uint64_t, n>& counts) {
  Json json = Json::object();
  for (std::size_t i = 0; i < n; ++i) json[std::string(name(static_cast<Enum>(i)))] = counts[i];
  return json;
}

template <class Enum, std::size_t n>
void read_counts(const Json& json, std::array<std::uint64_t, n>& counts) {
  for (std::size_t i = 0; i < n; ++i) {
    json.at(std::string(name(static_cast<Enum>(i)))).get_to(counts[i]);
  }
}

Json to_json(const SceneResult& scene) {
  const Tally& t = scene.tally;
  return {{"mesh", scene.mesh},
          {"triangles", scene.triangles},
          {"trajectories", t.trajectories},
          {"steps", t.steps},
          {"tips", t.tips},
          {"led_out", t.led_out},
          {"statuses", counts_to_json<Status>(t.statuses)},
          {"breaches", counts_to_json<Breach>(t.breaches)},
          {"least_beyond_margin", to_json(t.least)},
          {"least_beyond_margin_in_tau", to_json(t.least_in_tau)},
          {"seconds", t.seconds}};
}

SceneResult to_scene(const Json& json) {
  SceneResult scene{.mesh = json.at("mesh"), .triangles = json.at("triangles")};
  Tally& t = scene.tally;
  json.at("trajectories").get_to(t.trajectories);
  json.at("steps").get_to(t.steps);
  json.at("tips").get_to(t.tips);
  json.at("led_out").get_to(t.led_out);
  read_counts<Status>(json.at("statuses"), t.statuses);
  read_counts<Breach>(json.at("breaches"), t.breaches);
  t.least = to_double(json.at("least_beyond_margin"));
  t.least_in_tau = to_double(json.at("least_beyond_margin_in_tau"));
  json.at("seconds").get_to(t.seconds);
  return scene;
}

Json to_json(const Incident& i) {
  const StepOptions& o = i.setup.options;
  return {{"what", i.what},
          {"scene", i.scene},
          {"trajectory", i.trajectory},
          {"cycle", i.cycle},
          {"start", name(i.setup.start)},
          {"route", name(i.setup.route)},
          {"longest_step", i.setup.longest_step},
          {"joints", i.setup.joints},
          {"has_limits", i.setup.has_limits},
          {"start_tip", to_json(i.setup.tip)},
          {"radius", o.radius},
          {"margin", o.margin},
          {"damping", o.damping},
          {"recovery", o.recovery},
          {"refinements", o.refinements},
          {"nodes", o.nodes},
          {"query", o.query == Query::sphere ? "sphere" : "motion"},
          {"inside", i.setup.inside == Inside::led_out ? "led_out" : "taken_as_is"},
          {"tip", to_json(i.tip)},
          {"desired", to_json(i.desired)},
          {"motion", to_json(i.motion)},
          {"status", name(i.status)},
          {"jacobian", i.jacobian},
          {"row_matrix", i.row_matrix},
          {"row_bounds", i.row_bounds},
          {"distance", to_json(i.verdict.distance)},
          {"allowed", i.verdict.threshold},
          {"tau", i.verdict.tolerance},
          {"triangle", i.verdict.triangle}};
}

Incident to_incident(const Json& json) {
  Incident i;
  json.at("what").get_to(i.what);
  json.at("scene").get_to(i.scene);
  json.at("trajectory").get_to(i.trajectory);
  json.at("cycle").get_to(i.cycle);
  i.setup.start = from_name<Start>(json.at("start"), 8);
  i.setup.route = from_name<Route>(json.at("route"), 8);
  json.at("longest_step").get_to(i.setup.longest_step);
  json.at("joints").get_to(i.setup.joints);
  json.at("has_limits").get_to(i.setup.has_limits);
  i.setup.tip = to_vec3(json.at("start_tip"));
  StepOptions& o = i.setup.options;
  json.at("radius").get_to(o.radius);
  json.at("margin").get_to(o.margin);
  json.at("damping").get_to(o.damping);
  json.at("recovery").get_to(o.recovery);
  json.at("refinements").get_to(o.refinements);
  json.at("nodes").get_to(o.nodes);
  o.query = json.at("query") == "sphere" ? Query::sphere : Query::motion;
  i.setup.inside = json.at("inside") == "led_out" ? Inside::led_out : Inside::taken_as_is;
  i.tip = to_vec3(json.at("tip"));
  i.desired = to_vec3(json.at("desired"));
  if (!json.at("motion").at(0).is_null()) i.motion = to_vec3(json.at("motion"));
  i.status = from_name<Status>(json.at("status"), status_count);
  json.at("jacobian").get_to(i.jacobian);
  json.at("row_matrix").get_to(i.row_matrix);
  json.at("row_bounds").get_to(i.row_bounds);
  i.verdict.distance = to_double(json.at("distance"));
  json.at("allowed").get_to(i.verdict.threshold);
  json.at("tau").get_to(i.verdict.tolerance);
  json.at("triangle").get_to(i.verdict.triangle);
  return i;
}

template <class Item>
Json list(const std::vector<Item>& items) {
  Json json = Json::array();
  for (const Item& item : items) json.push_back(to_json(item));
  return json;
}

CampaignResult to_result(const Json& json) {
  const int its_format = json.at("keepout_verify").get<int>();
  if (its_format != format) {
    throw Error("written by another version of keepout verify (format " +
                std::to_string(its_format) + ", not " + std::to_string(format) + ")");
  }
  CampaignResult result;
  json.at("version").get_to(result.version);
  json.at("seed").get_to(result.seed);
  json.at("steps").get_to(result.steps);
  json.at("index").get_to(result.index);
  json.at("shard_count").get_to(result.shard_count);
  for (const Json& shard : json.at("shards")) {
    result.shards.push_back({shard.at("index"), shard.at("seconds"), shard.at("machine"),
                             shard.value("complete", true)});
  }
  json.at("missing").get_to(result.missing);
  for (const Json& scene : json.at("meshes")) result.findings.scenes.push_back(to_scene(scene));
  for (const Json& i : json.at("breaches")) result.findings.breaches.push_back(to_incident(i));
  for (const Json& i : json.at("anomalies")) result.findings.anomalies.push_back(to_incident(i));
  return result;
}

}  // namespace

void write_json(std::ostream& out, const CampaignResult& result) {
  Json shards = Json::array();
  for (const ShardRun& shard : result.shards) {
    shards.push_back({{"index", shard.index},
                      {"seconds", shard.seconds},
                      {"machine", shard.machine},
                      {"complete", shard.is_whole}});
  }
  Json total = to_json(SceneResult{.mesh = "total", .tally = result.findings.total()});
  total.erase("triangles");
  const Json json{{"keepout_verify", format},
                  {"version", result.version},
                  {"seed", result.seed},
                  {"steps", result.steps},
                  {"steps_done", result.findings.total().steps},
                  {"complete", is_complete(result)},
                  {"index", result.index},
                  {"shard_count", result.shard_count},
                  {"shards", shards},
                  {"missing", result.missing},
                  {"meshes", list(result.findings.scenes)},
                  {"total", total},
                  {"breaches", list(result.findings.breaches)},
                  {"anomalies", list(result.findings.anomalies)}};
  out << json.dump(1, ' ', false, Json::error_handler_t::replace) << '\n';
}

CampaignResult read_json(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw Error(path.string() + ": cannot be read; is it there?");
  try {
    return to_result(Json::parse(file));
  } catch (const Json::exception&) {
    throw Error(path.string() + ": is not a whole result of 'keepout verify --json'");
  } catch (const Error& error) {
    throw Error(path.string() + ": " + error.what());
  }
}

}  // namespace keepout::app
