// SPDX-License-Identifier: BSD-3-Clause
#include "bodies_file.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "keepout/error.h"
#include "keepout/registry.h"
#include "keepout/robot/instrument.h"

namespace keepout {
namespace {

using Json = nlohmann::json;
constexpr int deepest = 8;
constexpr std::size_t longest_text = 100;  // of a name, and in messages

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw Error((where.empty() ? "the file" : where) + " " + what);
}

/// Returns the beginning of a value, for messages, in printable characters.
std::string shown(const Json& value) {
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > longest_text) text = text.substr(0, longest_text) + "...";
  return text;
}

Json parsed(std::string_view text) {
  std::vector<std::set<std::string>> keys;
  const auto listen = [&](int depth, Json::parse_event_t event, const Json& value) {
    if (depth > deepest) throw Error("nested more deeply than any file of bodies");
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key) {
      const auto& key = value.get_ref<const std::string&>();
      if (!keys.back().insert(key).second) refuse("the field " + shown(value), "is given twice");
    }
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), listen);
  } catch (const Json::exception& error) {
    std::string cause = error.what();
    for (const std::string_view lead : {"parse error at ", "] "}) {
      const std::size_t at = cause.find(lead);
      if (at == std::string::npos) continue;
      cause = cause.substr(at + lead.size());
      break;
    }
    for (char& c : cause) c = c >= ' ' && c <= '~' ? c : '?';
    throw Error("is not JSON: " + cause.substr(0, 200) + "; repair it there");
  }
}

/// Throws Error for a value that is not an object, or has a field of another name.
void require_fields(const Json& value, const std::string& where,
                    std::initializer_list<std::string_view> known) {
  std::string all;
  for (const std::string_view name : known) all += (all.empty() ? "" : ", ") + std::string(name);
  if (!value.is_object()) refuse(where, "must be an object with " + all + ", not " + shown(value));
  for (const auto& [key, member] : value.items()) {
    if (std::ranges::find(known, key) != known.end()) continue;
    const auto meant = nearest_name(key, std::span(known.begin(), known.size()));
    refuse(where,
           "has an unknown field " + shown(Json(key)) + "; " +
               (meant ? "did you mean \"" + std::string(*meant) + "\"?" : "there are: " + all));
  }
}

std::string member(const std::string& where, const std::string& name) {
  return where.empty() ? name : where + "." + name;
}

const Json& needed(const Json& value, const std::string& where, const char* name,
                   const std::string& expected) {
  if (value.contains(name)) return value[name];
  refuse(where, "has no \"" + std::string(name) + "\": write " + expected);
}

std::string text_of(const Json& value, const std::string& where) {
  const bool is_text = value.is_string() && !value.get_ref<const std::string&>().empty() &&
                       value.get_ref<const std::string&>().size() <= longest_text;
  if (!is_text) refuse(where, "must be a name in quotes, not " + shown(value));
  return value.get<std::string>();
}

Vec3 vector_of(const Json& value, const std::string& where) {
  const bool is_vector =
      value.is_array() && value.size() == 3 && std::ranges::all_of(value, [](const Json& item) {
        return item.is_number() && std::isfinite(item.get<double>());
      });
  if (!is_vector) refuse(where, "must be an array of three finite numbers, not " + shown(value));
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

/// Returns a value as an array of 1 to `most` items.
const Json& array_of(const Json& value, const std::string& where, std::size_t most) {
  if (value.is_array() && !value.empty() && value.size() <= most) return value;
  const std::string limits = "an array of 1 to " + std::to_string(most);
  if (!value.is_array()) refuse(where, "must be " + limits + ", not " + shown(value));
  refuse(where, "must be " + limits + ", and has " + std::to_string(value.size()));
}

Pose pose_of(const Json& value, const std::string& where) {
  require_fields(value, where, {"xyz_mm", "rpy_rad"});
  Pose pose;
  if (value.contains("xyz_mm")) pose.position = vector_of(value["xyz_mm"], member(where, "xyz_mm"));
  if (value.contains("rpy_rad")) {
    const Vec3 rpy = vector_of(value["rpy_rad"], member(where, "rpy_rad"));
    pose.rotation =
        (Eigen::AngleAxisd(rpy.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vec3::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Vec3::UnitX()))
            .toRotationMatrix();
  }
  return pose;
}

BodiesFile::Entry entry_of(const Json& value, const std::string& where) {
  require_fields(value, where, {"name", "radius_mm", "points"});
  BodiesFile::Entry entry{
      .name = text_of(needed(value, where, "name", "a name"), member(where, "name")),
      .points = {},
      .radius = 0.0};
  const bool is_plain = std::ranges::all_of(entry.name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  });
  if (!is_plain) {
    refuse(member(where, "name"),
           "may have letters, digits, '_', '-' and '.', not " + shown(value["name"]));
  }
  const Json& radius = needed(value, where, "radius_mm", "a radius in mm");
  const bool is_radius =
      radius.is_number() && std::isfinite(radius.get<double>()) && radius.get<double>() >= 0.0;
  if (!is_radius) {
    refuse(member(where, "radius_mm"),
           "must be a number of at least 0, in mm, not " + shown(radius));
  }
  entry.radius = radius.get<double>();
  const std::string of_points = member(where, "points");
  const Json& points = array_of(needed(value, where, "points", "the points of its core"), of_points,
                                Instrument::most_points_of_a_body);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string at = of_points + "[" + std::to_string(i) + "]";
    require_fields(points[i], at, {"link", "xyz_mm"});
    entry.points.push_back(
        {text_of(needed(points[i], at, "link", "the name of a link"), member(at, "link")),
         vector_of(needed(points[i], at, "xyz_mm", "[x, y, z] in the frame of the link, in mm"),
                   member(at, "xyz_mm"))});
  }
  return entry;
}

}  // namespace

BodiesFile parse_bodies(std::string_view text) {
  if (text.size() > most_bytes_of_bodies) throw Error("is larger than 1 MiB: is it another file?");
  const Json json = parsed(text);
  require_fields(json, "", {"base", "tip", "base_pose", "bodies"});
  BodiesFile file;
  if (json.contains("base")) file.base = text_of(json["base"], "base");
  if (json.contains("tip")) file.tip = text_of(json["tip"], "tip");
  if (json.contains("base_pose")) file.base_pose = pose_of(json["base_pose"], "base_pose");
  if (!json.contains("bodies")) return file;
  const Json& bodies = array_of(json["bodies"], "bodies", Instrument::most_bodies);
  file.bodies.emplace();
  std::set<std::string> used;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string where = "bodies[" + std::to_string(b) + "]";
    BodiesFile::Entry& entry = file.bodies->emplace_back(entry_of(bodies[b], where));
    if (used.insert(entry.name).second) continue;
    refuse(member(where, "name"),
           "is the name of another body: rename one of the bodies called '" + entry.name + "'");
  }
  return file;
}

}  // namespace keepout
