// SPDX-License-Identifier: BSD-3-Clause
#include "serve/service.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "keepout/mesh/doctor.h"
#include "keepout/version.h"
#include "serve/answer.h"

namespace keepout::app {
namespace {

constexpr int protocol = 1;  // goes up when an old client would no longer be understood

/// With room for the largest request. A client has no other way to a distance than a step.
MotionConstraintSettings with_room_for(MotionConstraintSettings settings,
                                       const RequestLimits& limits) {
  settings.distances = Distances::always;
  settings.capacity.variables = std::max<std::size_t>(limits.joints, 3);
  settings.capacity.extra_rows = limits.rows;
  return settings;
}

std::string info_members(const Mesh& mesh, const ServiceSettings& settings) {
  using OrderedJson = nlohmann::ordered_json;
  const MotionConstraintSettings& c = settings.constraint;
  const auto array = [](const Vec3& v) { return OrderedJson{v.x(), v.y(), v.z()}; };
  const std::string space(name(settings.space));
  OrderedJson info{{"version", KEEPOUT_VERSION},
                   {"protocol", protocol},
                   {"unit", "mm"},
                   {"frame", "of the mesh"},
                   {"mesh",
                    {{"file", settings.mesh.string()},
                     {"space", space},
                     {"triangles", mesh.triangle_count()},
                     {"vertices", mesh.vertex_count()},
                     {"low", array(mesh.bounds().low)},
                     {"high", array(mesh.bounds().high)},
                     {"watertight", is_watertight(mesh)}}},
                   {"settings",
                    {{"index", c.index},
                     {"activation", c.activation},
                     {"solver", c.solver},
                     {"radius", c.radius},
                     {"tool_radius", c.tool_radius},
                     {"margin", c.margin},
                     {"damping", c.damping},
                     {"recovery", c.recovery},
                     {"deepest", c.deepest},
                     {"refinements", c.refinements},
                     {"branches", c.nodes},
                     {"query", c.query == Query::motion ? "motion" : "sphere"}}},
                   {"limits",
                    {{"line", settings.longest_line},
                     {"joints", settings.limits.joints},
                     {"rows", settings.limits.rows},
                     {"motions", settings.limits.motions}}}};
  // A path need not be UTF-8.
  const std::string text = info.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
  return text.substr(1, text.size() - 2);
}

Vec3 vector(std::span<const double> numbers) { return {numbers[0], numbers[1], numbers[2]}; }

bool is_blank(std::string_view text) {
  return text.find_first_not_of(" \t\r") == std::string_view::npos;
}

}  // namespace

Service::Service(std::shared_ptr<const Mesh> mesh, const ServiceSettings& settings)
    : constraint_(
          make_motion_constraint(mesh, with_room_for(settings.constraint, settings.limits))),
      longest_line_(settings.longest_line),
      reader_(settings.limits),
      jacobian_(3, static_cast<Eigen::Index>(settings.limits.joints)),
      info_(info_members(*mesh, settings)),
      statuses_(status_members()) {}

std::size_t Service::answer(const Line& line, SideWatch& tip, std::string& out) {
  if (line.is_too_long) {
    append_error(out, "null", name(Refusal::line_too_long),
                 "the line has more than " + std::to_string(longest_line_) +
                     " bytes and was skipped: send less at a time, or raise --max-line");
    return 1;
  }
  if (is_blank(line.text)) return 0;
  const Refusal refusal = reader_.read(line.text);
  if (refusal != Refusal::none) {
    append_error(out, reader_.request().id, name(refusal), reader_.message());
    return 1;
  }
  begin_answer(out, reader_.request().id);
  const std::size_t work = carry_out(tip, out);
  end_answer(out);
  return work;
}

std::size_t Service::carry_out(SideWatch& tip, std::string& out) {
  const Request& request = reader_.request();
  out += ',';
  switch (request.verb) {
    case Verb::step:
      append_single_step(tip, out);
      break;
    case Verb::steps:
      append_batch(tip, out);
      return std::max<std::size_t>(request.motions.rows, 1);
    case Verb::polytope:
      append_polytope(
          out, constraint_.free_polytope(vector(request.tip.numbers), request.radius.numbers[0]));
      break;
    case Verb::info:
      out += info_;
      break;
    case Verb::statuses:
      out += statuses_;
      break;
    case Verb::ping:
      out += "\"ok\":true";
      break;
  }
  return 1;
}

void Service::append_single_step(SideWatch& tip, std::string& out) {
  const Request& request = reader_.request();
  Motion motion{.tip = vector(request.tip.numbers), .desired = vector(request.desired.numbers)};
  const std::size_t joints = request.jacobian.columns;
  if (joints > 0) {
    const double* row = request.jacobian.numbers.data();
    for (Eigen::Index r = 0; r < 3; ++r) {
      for (Eigen::Index c = 0; c < std::ssize(request.jacobian.numbers) / 3; ++c) {
        jacobian_(r, c) = *row++;
      }
    }
    motion.jacobian = TipJacobian(jacobian_.data(), static_cast<Eigen::Index>(joints));
  }
  if (request.rows.is_given) {
    motion.rows = ExtraRows(request.rows.numbers.data(), request.bounds.numbers.data(),
                            static_cast<Eigen::Index>(request.rows.rows));
  }
  append_step(out, constraint_.step(motion, tip), joints);
}

void Service::append_batch(SideWatch& tip, std::string& out) {
  const std::span<const double> numbers = reader_.request().motions.numbers;
  out += "\"steps\":[";
  for (std::size_t i = 0; i < numbers.size(); i += 6) {
    const Motion motion{.tip = vector(numbers.subspan(i)),
                        .desired = vector(numbers.subspan(i + 3))};
    out += i == 0 ? "{" : ",{";
    append_step(out, constraint_.step(motion, tip), 0);
    out += '}';
  }
  out += ']';
}

}  // namespace keepout::app
