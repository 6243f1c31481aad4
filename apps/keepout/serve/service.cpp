// SPDX-License-Identifier: BSD-3-Clause
#include "serve/service.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "keepout/error.h"
#include "keepout/factory/for_each_option.h"
#include "keepout/mesh/diagnostics.h"
#include "keepout/version.h"
#include "serve/answer.h"
#include "shared/names.h"

namespace keepout::app {
namespace {

constexpr int protocol = 2;  // increases with each change that an old client would not understand
constexpr std::size_t enough_output = std::size_t{1} << 16;  // of one turn [bytes]

/// Returns the settings with capacity for the largest request.
MotionConstraintSettings with_room_for(MotionConstraintSettings settings,
                                       const RequestLimits& limits) {
  settings.capacity.variables = std::max<std::size_t>(limits.joints, 3);
  settings.capacity.extra_rows = limits.rows;
  return settings;
}

/// Returns the JSON of an object without its braces.
std::string members_of(const Json& object) {
  // A path may be invalid UTF-8.
  const std::string text = object.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.substr(1, text.size() - 2);
}

/// Returns all statuses and the names of all limits. `reason` is the reason for a tip.
Json statuses_and_limits() {
  Json statuses = Json::array();
  for (std::size_t i = 0; i < status_count; ++i) {
    const auto status = static_cast<Status>(i);
    statuses.push_back({{"ok", is_ok(status)},
                        {"status", name(status)},
                        {"reason", reason(status, Subject::tip)},
                        {"instrument_reason", reason(status, Subject::instrument)},
                        {"polytope_reason", reason(status, Subject::polytope)}});
  }
  Json limits = Json::array();
  for (std::size_t i = 0; i < limit_count; ++i) limits.push_back(name(static_cast<Limit>(i)));
  return {{"statuses", statuses}, {"limits", limits}};
}

Json info_on(const Mesh& mesh, const ServiceSettings& settings, const MotionConstraintSettings& c) {
  Json options{{"index", c.index}, {"convex_tool", c.tool.has_value()}};
  for_each_option(c, [&](const auto& option, const auto& of) {
    std::visit([&](const auto& value) { options[std::string(option.name)] = value; },
               option.get(of));
  });
  const auto array = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}; };
  return {{"version", KEEPOUT_VERSION},
          {"protocol", protocol},
          {"unit", "mm"},
          {"frame", "of the mesh"},
          {"mesh",
           {{"file", settings.mesh.string()},
            {"space", std::string(name(settings.space))},
            {"notices", settings.notices},
            {"triangles", mesh.triangle_count()},
            {"vertices", mesh.vertex_count()},
            {"low", array(mesh.bounds().low)},
            {"high", array(mesh.bounds().high)},
            {"watertight", is_watertight(mesh)}}},
          {"settings", options},
          {"limits",
           {{"line", settings.longest_line},
            {"joints", settings.limits.joints},
            {"rows", settings.limits.rows},
            {"motions", settings.limits.motions}}}};
}

/// Appends the answer to a line. Returns the work in steps. A blank line counts as one step, so
/// that many of them do not block other clients.
std::size_t answer(Client& client, std::string_view line, std::string& out) {
  const Service& service = client.service;
  const bool is_too_long =
      std::exchange(client.is_skipping, false) || line.size() > service.longest_line;
  if (!is_too_long && line.find_first_not_of(" \t\r") == std::string_view::npos) return 1;
  const std::size_t before = out.size();
  std::string id = "null";
  try {
    if (is_too_long) {
      throw Refusal{"line_too_long",
                    "the line has more than " + std::to_string(service.longest_line) +
                        " bytes and was skipped: send shorter lines, or raise --max-line"};
    }
    Json request;
    const Verb& verb = service.requests.read(line, id, request);
    out.append("{\"id\":").append(id);
    try {
      verb.carry_out(client, request, out);
    } catch (const Error& error) {
      throw Refusal{verb.refusal, printable(error.what())};
    }
    out += "}\n";
    return std::max(verb.work, request.contains("motions") ? request["motions"].size() : 0);
  } catch (const Refusal& refusal) {
    out.resize(before);
    append_error(out, id, refusal.kind, refusal.message);
    return 1;
  }
}

}  // namespace

Service::Service(std::shared_ptr<const Mesh> served, const ServiceSettings& settings)
    : mesh(std::move(served)),
      index(make_or_load_index(mesh, settings.constraint)),
      instrument{.solver = settings.constraint.solver,
                 .options = {.margin = settings.constraint.options.margin,
                             .recovery = settings.constraint.options.recovery}},
      tip(with_room_for(settings.constraint, settings.limits)),
      constraint(make_motion_constraint(mesh, index, tip)),
      longest_line(settings.longest_line),
      requests(settings.limits, verbs()),
      info(members_of(info_on(*mesh, settings, tip))),
      statuses(members_of(statuses_and_limits())) {}

std::size_t most_received(const Service& service) noexcept {
  return service.longest_line + std::string_view("\r\n").size();
}

std::size_t take_turn(Client& client, std::string_view received, std::string& answers) {
  std::size_t begin = 0;
  for (std::size_t work = 0; work < most_work && answers.size() < enough_output;) {
    const std::size_t end = received.find('\n', begin);
    if (end == std::string_view::npos) {
      if (received.size() - begin < most_received(client.service)) break;
      client.is_skipping = true;
      return received.size();
    }
    std::string_view line = received.substr(begin, end - begin);
    begin = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    work += answer(client, line, answers);
  }
  return begin;
}

}  // namespace keepout::app
