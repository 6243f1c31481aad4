// SPDX-License-Identifier: BSD-3-Clause
#include "serve/service.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "keepout/factory/for_each_option.h"
#include "keepout/mesh/doctor.h"
#include "keepout/version.h"
#include "serve/answer.h"

namespace keepout::app {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr int protocol = 1;             // goes up when an old client would no longer be understood
constexpr std::size_t longest_end = 2;  // of a line: "\r\n" [bytes]
constexpr std::size_t most_work = 16;   // of a turn, in steps
constexpr std::size_t enough_output = std::size_t{1} << 16;  // for a turn [bytes]

/// With capacity for the largest request.
MotionConstraintSettings with_room_for(MotionConstraintSettings settings,
                                       const RequestLimits& limits) {
  settings.capacity.variables = std::max<std::size_t>(limits.joints, 3);
  settings.capacity.extra_rows = limits.rows;
  return settings;
}

/// Without its braces.
std::string members_of(const OrderedJson& object) {
  // A path need not be UTF-8.
  const std::string text = object.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
  return text.substr(1, text.size() - 2);
}

/// Returns all statuses: `reason` is that of a tip.
OrderedJson statuses() {
  OrderedJson list = OrderedJson::array();
  for (std::size_t i = 0; i < status_count; ++i) {
    const auto status = static_cast<Status>(i);
    list.push_back({{"ok", is_ok(status)},
                    {"status", name(status)},
                    {"reason", reason(status, Subject::tip)},
                    {"instrument_reason", reason(status, Subject::instrument)},
                    {"polytope_reason", reason(status, Subject::polytope)}});
  }
  return list;
}

/// Returns the names of all limits.
OrderedJson limits() {
  OrderedJson list = OrderedJson::array();
  for (std::size_t i = 0; i < limit_count; ++i) list.push_back(name(static_cast<Limit>(i)));
  return list;
}

OrderedJson info(const Mesh& mesh, const ServiceSettings& settings,
                 const MotionConstraintSettings& c) {
  OrderedJson options{{"index", c.index}, {"convex_tool", c.tool.has_value()}};
  for_each_option(c, [&](const auto& option, const auto& of) {
    std::visit([&](const auto& value) { options[std::string(option.name)] = value; },
               option.get(of));
  });
  const auto array = [](const Vec3& v) { return OrderedJson{v.x(), v.y(), v.z()}; };
  const std::string space(name(settings.space));
  return {{"version", KEEPOUT_VERSION},
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
          {"settings", options},
          {"limits",
           {{"line", settings.longest_line},
            {"joints", settings.limits.joints},
            {"rows", settings.limits.rows},
            {"motions", settings.limits.motions}}}};
}

Vec3 vector(std::span<const double> numbers) { return {numbers[0], numbers[1], numbers[2]}; }

bool is_blank(std::string_view text) {
  return text.find_first_not_of(" \t\r") == std::string_view::npos;
}

}  // namespace

LineReader::LineReader(std::size_t longest) : longest_(longest), buffer_(longest + longest_end) {}

std::span<char> LineReader::room() noexcept {
  if (begin_ == end_) {
    begin_ = searched_ = end_ = 0;
  } else if (begin_ > 0 && end_ == buffer_.size()) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    searched_ -= begin_;
    end_ -= begin_;
    begin_ = 0;
  }
  return {buffer_.data() + end_, buffer_.size() - end_};
}

std::optional<Line> LineReader::next() noexcept {
  const auto first = buffer_.begin() + static_cast<std::ptrdiff_t>(searched_);
  const auto last = buffer_.begin() + static_cast<std::ptrdiff_t>(end_);
  const auto newline = std::find(first, last, '\n');
  if (newline != last) {
    const auto at = static_cast<std::size_t>(newline - buffer_.begin());
    return finished(at, at + 1);
  }
  searched_ = end_;
  if (has_ended_ && (begin_ < end_ || is_skipping_)) return finished(end_, end_);
  if (is_skipping_ || end_ - begin_ == buffer_.size()) {
    is_skipping_ = true;
    begin_ = searched_ = end_ = 0;
  }
  return std::nullopt;
}

std::optional<Line> LineReader::finished(std::size_t line_end, std::size_t next_begin) noexcept {
  std::string_view text(buffer_.data() + begin_, line_end - begin_);
  if (text.ends_with('\r')) text.remove_suffix(1);
  begin_ = searched_ = next_begin;
  const bool is_too_long = is_skipping_ || text.size() > longest_;
  is_skipping_ = false;
  return Line{is_too_long, is_too_long ? std::string_view() : text};
}

Service::Service(std::shared_ptr<const Mesh> mesh, const ServiceSettings& settings)
    : mesh_(mesh),
      index_(make_or_load_index(mesh, settings.constraint)),
      instrument_{.solver = settings.constraint.solver,
                  .options = {.margin = settings.constraint.options.margin,
                              .recovery = settings.constraint.options.recovery}},
      settings_(with_room_for(settings.constraint, settings.limits)),
      constraint_(make_motion_constraint(mesh, index_, settings_)),
      longest_line_(settings.longest_line),
      limits_(settings.limits),
      request_(settings.limits),
      jacobian_(3, static_cast<Eigen::Index>(settings.limits.joints)),
      info_(members_of(info(*mesh, settings, settings_))),
      statuses_(members_of({{"statuses", statuses()}, {"limits", limits()}})) {}

std::size_t Service::answer(const Line& line, Client& client, std::string& out) {
  if (line.is_too_long) {
    append_error(out, "null", "line_too_long",
                 "the line has more than " + std::to_string(longest_line_) +
                     " bytes and was skipped: send less at a time, or raise --max-line");
    return 1;
  }
  if (is_blank(line.text)) return 0;
  const std::size_t before = out.size();
  try {
    read_request(line.text, request_);
    begin_answer(out, request_.id);
    const std::size_t work = carry_out(client, out);
    end_answer(out);
    return work;
  } catch (const Refusal& refusal) {
    out.resize(before);
    append_error(out, request_.id, refusal.kind, refusal.message);
    return 1;
  }
}

std::size_t Service::carry_out(Client& client, std::string& out) {
  out += ',';
  switch (request_.verb) {
    case Verb::step:
      append_single_step(client, out);
      break;
    case Verb::steps:
      append_batch(client, out);
      return std::max<std::size_t>(request_.table("motions").rows, 1);
    case Verb::polytope:
      append_polytope(out,
                      constraint_of(client).free_polytope(vector(request_.table("tip").numbers),
                                                          request_.table("radius").numbers[0]));
      break;
    case Verb::info:
      out += info_;
      break;
    case Verb::statuses:
      out += statuses_;
      break;
    case Verb::instrument:
      open_instrument(client, mesh_, index_, instrument_, request_);
      append_instrument(out, client.instrument->instrument());
      return most_work;
    case Verb::tool:
      open_tool(client, mesh_, index_, settings_, request_);
      out += "\"ok\":true";
      return most_work;
    case Verb::joint_step: {
      const InstrumentStep step = joint_step(client, request_);
      append_joint_step(out, step, request_.table("q").columns);
      if (client.instrument->mesh_count() > 1 && step.distance) {
        out += ",\"nearest_mesh\":" + std::to_string(step.nearest_mesh);
      }
      append_guides(out, client.guide_names, step.guides, step.relaxation);
      break;
    }
    case Verb::guides:
      set_guides(client, mesh_, index_, settings_, request_);
      out += "\"ok\":true";
      break;
    case Verb::anatomy:
      out += "\"ok\":true,\"mesh\":" + std::to_string(add_anatomy(client, settings_, request_));
      return most_work;
    case Verb::place:
      place_anatomy(client, request_);
      out += "\"ok\":true";
      break;
    case Verb::ping:
      out += "\"ok\":true";
      break;
  }
  return 1;
}

/// Returns the client's own constraint, or the one that clients share.
MotionConstraint& Service::constraint_of(Client& client) noexcept {
  return client.own ? *client.own : constraint_;
}

Step Service::step(Client& client, const Motion& motion) noexcept {
  return constraint_of(client).step(motion, client.tip);
}

void Service::append_single_step(Client& client, std::string& out) {
  Motion motion{.tip = vector(request_.table("tip").numbers),
                .desired = vector(request_.table("desired").numbers)};
  const auto joints = static_cast<Eigen::Index>(request_.table("jacobian").columns);
  if (joints > 0) {
    using RowByRow = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
    jacobian_.leftCols(joints) =
        Eigen::Map<const RowByRow>(request_.table("jacobian").numbers.data(), 3, joints);
    motion.jacobian = TipJacobian(jacobian_.data(), joints);
  }
  if (request_.table("rows").is_given) {
    motion.rows =
        ExtraRows(request_.table("rows").numbers.data(), request_.table("bounds").numbers.data(),
                  static_cast<Eigen::Index>(request_.table("rows").rows));
  }
  const Step step = this->step(client, motion);
  append_step(out, step, request_.table("jacobian").columns);
  append_guides(out, client.tip_guide_names, step.guides, step.relaxation);
}

void Service::append_batch(Client& client, std::string& out) {
  const std::span<const double> numbers = request_.table("motions").numbers;
  out += "\"steps\":[";
  for (std::size_t i = 0; i < numbers.size(); i += 6) {
    const Motion motion{.tip = vector(numbers.subspan(i)),
                        .desired = vector(numbers.subspan(i + 3))};
    out += i == 0 ? "{" : ",{";
    append_step(out, step(client, motion), 0);
    out += '}';
  }
  out += ']';
}

Session::Session(Service& service) : service_(service), lines_(service.longest_line()) {
  out_.reserve(enough_output / 4);
}

void Session::take_turn() {
  std::size_t work = 0;
  while (work < most_work && out_.size() < enough_output) {
    const std::optional<Line> line = lines_.next();
    may_have_line_ = line.has_value();
    if (!line) return;
    // A blank line is no work, but a sea of them must not hold up the others.
    work += std::max<std::size_t>(service_.answer(*line, client_, out_), 1);
  }
}

void Session::sent(std::size_t count) noexcept {
  sent_ += count;
  if (sent_ < out_.size()) return;
  out_.clear();
  sent_ = 0;
}

}  // namespace keepout::app
