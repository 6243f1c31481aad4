// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "keepout/error.h"
#include "keepout/factory/convex_tool_text.h"
#include "keepout/factory/guide_text.h"
#include "keepout/robot/instrument_options.h"
#include "serve/answer.h"
#include "serve/service.h"
#include "shared/names.h"
#if KEEPOUT_HAS_URDF
#include "keepout/urdf/read_chain.h"
#include "keepout/urdf/read_robot.h"
#endif

namespace keepout::app {
namespace {

Vec3 vector(std::span<const double> numbers) { return {numbers[0], numbers[1], numbers[2]}; }

/// Returns the three numbers of a key; zeros without this key.
Vec3 vector(const Json& request, std::string_view key) {
  return request.contains(key) ? vector(numbers(request, key)) : Vec3::Zero();
}

Twist twist_of(const Json& request) {
  return {.linear = vector(request, "linear"), .angular = vector(request, "angular")};
}

Pose frame_of(const Json& request) {
  if (!request.contains("frame")) return {};
  using RowByRow = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const RowByRow m(numbers(request, "frame").data());
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw Error("the last row of 'frame' must be 0, 0, 0, 1");
  }
  return {m.topRightCorner<3, 1>(), m.topLeftCorner<3, 3>()};
}

/// Returns the path of a key. Throws Error unless it is a regular file: a pipe would block all
/// clients.
std::filesystem::path file_of(const Json& request, const char* key) {
  const std::string text = request[key].get<std::string>();
  std::error_code trouble;
  if (!std::filesystem::is_regular_file(text, trouble)) {
    throw Error(in_quotes(key) + " must name a file, which " + in_quotes(text) + " does not");
  }
  return text;
}

/// Returns the point of a link: the link's number, and three coordinates.
LinkPoint link_point(std::span<const double> numbers) {
  const double link = numbers[0];
  if (!(link >= 0.0 && link <= Chain::most_joints && link == std::floor(link))) {
    throw Error("a link of 'capsules' must be a number from 0 to that of the last joint, not " +
                keepout::text_of(link));
  }
  return {static_cast<int>(link), vector(numbers.subspan(1))};
}

/// An instrument, and sentences about its file.
struct ReadInstrument {
  Instrument instrument;
  std::vector<std::string> notices = {};
};

#if KEEPOUT_HAS_URDF
Chain read_chain_of(const Json& request) {
  UrdfChain chain = read_chain(file_of(request, "urdf"), request.value("base_link", ""),
                               request.value("tip_link", ""), request.value("scale", 1000.0));
  return Chain(std::move(chain.joints), frame_of(request), chain.flange);
}

/// Returns the robot of the files "urdf" and "bodies". The request's frame replaces the pose in the
/// file of bodies.
ReadInstrument read_robot_of(const Json& request) {
  UrdfRobot robot = read_robot(file_of(request, "urdf"),
                               request.contains("bodies") ? file_of(request, "bodies") : "",
                               request.value("base_link", ""), request.value("tip_link", ""),
                               request.value("scale", 1000.0));
  if (!request.contains("frame")) return {std::move(robot.instrument), std::move(robot.notices)};
  const Chain& chain = robot.instrument.chain();
  std::vector<Joint> joints;
  for (int k = 1; k <= chain.size(); ++k) joints.push_back(chain.joint(k));
  const auto bodies = robot.instrument.bodies();
  return {Instrument(Chain(std::move(joints), frame_of(request), chain.flange()),
                     {bodies.begin(), bodies.end()}),
          std::move(robot.notices)};
}
#else
[[noreturn]] void refuse_urdf() {
  throw Error(
      "this build reads no URDF: install liburdfdom-dev and liburdfdom-headers-dev, and build it "
      "again");
}
Chain read_chain_of(const Json&) { refuse_urdf(); }
ReadInstrument read_robot_of(const Json&) { refuse_urdf(); }
#endif

ReadInstrument read_instrument(const Json& request) {
  if (!request.contains("capsules")) return read_robot_of(request);
  if (request.contains("bodies")) {
    throw Error("'capsules' and 'bodies' both describe the bodies: omit one of them");
  }
  std::vector<Body> bodies;
  const std::vector<double> capsules = numbers(request, "capsules");
  for (std::size_t i = 0; i < capsules.size(); i += 9) {
    const std::span<const double> row = std::span(capsules).subspan(i, 9);
    bodies.push_back({.points = {link_point(row), link_point(row.subspan(4))}, .radius = row[8]});
  }
  return {Instrument(read_chain_of(request), std::move(bodies))};
}

std::vector<std::string_view> keys_of_instruments() {
  std::vector<std::string_view> keys{"capsules", "bodies", "base_link", "tip_link",
                                     "scale",    "frame",  "index",     "solver"};
  for (const auto& option : instrument_options) keys.push_back(option.name);
  return keys;
}

/// Returns the client's own constraint, or else the constraint that clients share.
MotionConstraint& tip_of(Client& client) noexcept {
  return client.tip.constraint ? *client.tip.constraint : client.service.constraint;
}

InstrumentConstraint& instrument_of(Client& client) {
  if (client.instrument.constraint) return *client.instrument.constraint;
  throw Refusal{"no_instrument", "there is no instrument yet: open one, with 'instrument'"};
}

void step(Client& client, const Json& request, std::string& out) {
  const std::vector<double> jacobian = numbers(request, "jacobian");
  const std::vector<double> rows = numbers(request, "rows");
  const std::vector<double> bounds = numbers(request, "bounds");
  const std::size_t joints = jacobian.size() / 3;
  if (request.contains("rows") != request.contains("bounds")) {
    refuse("'rows' and 'bounds' belong together: rows . u >= bounds");
  }
  if (request.contains("rows") && request["rows"].size() != bounds.size()) {
    refuse("'bounds' must have one number for each of the 'rows'");
  }
  if (rows.size() != bounds.size() * (joints > 0 ? joints : 3)) {
    refuse(
        "each of the 'rows' must have one number for each column of the 'jacobian', or three "
        "without one");
  }
  Motion motion{.tip = vector(request, "tip"), .desired = vector(request, "desired")};
  using RowByRow = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
  const TipJacobian::Matrix matrix =
      Eigen::Map<const RowByRow>(jacobian.data(), 3, static_cast<Eigen::Index>(joints));
  if (joints > 0) motion.jacobian = TipJacobian(matrix);
  if (request.contains("rows")) {
    motion.rows = ExtraRows(rows.data(), bounds.data(), std::ssize(bounds));
  }
  const Step step = tip_of(client).step(motion, client.side);
  append_step(out, step, joints);
  append_guides(out, client.tip.guide_names, step.guides, step.relaxation);
}

void steps(Client& client, const Json& request, std::string& out) {
  append_member(
      out, "steps",
      request["motions"] | std::views::transform([&](const Json& row) {
        return [&](std::string& object) {
          const std::vector<double> motion = numbers(row);
          const Vec3 desired = vector(std::span(motion).subspan(3));
          append_step(object, tip_of(client).step({vector(motion), desired}, client.side), 0);
        };
      }));
}

void polytope(Client& client, const Json& request, std::string& out) {
  append_polytope(out, tip_of(client).free_polytope(vector(request, "tip"),
                                                    numbers(request, "radius").front()));
}

void open_instrument(Client& client, const Json& request, std::string& out) {
  InstrumentConstraintSettings settings = client.service.instrument;
  for (const auto& option : instrument_options) {
    if (!request.contains(option.name)) continue;
    option.set(settings.options, *option_value(request[option.name], option.kind));
  }
  settings.solver = request.value("solver", settings.solver);
  settings.monitor = client.service.tip.monitor;
  ReadInstrument read = read_instrument(request);  // before an index is built in vain
  MotionConstraintSettings of_index = client.service.tip;
  of_index.index = request.value("index", of_index.index);
  const auto index = of_index.index == client.service.tip.index
                         ? client.service.index
                         : make_or_load_index(client.service.mesh, of_index);
  client.instrument = {
      make_instrument_constraint(client.service.mesh, index, std::move(read.instrument), settings)};
  const Instrument& opened = instrument_of(client).instrument();
  append_member(out, "ok", true);
  append_member(out, "joints",
                std::views::iota(1, opened.chain().size() + 1) |
                    std::views::transform([&](int k) { return opened.chain().joint(k).name; }));
  append_member(out, "bodies", opened.bodies().size());
  if (request.contains("capsules")) return;
  append_member(out, "body_names", opened.bodies() | std::views::transform(&Body::name));
  append_member(out, "notices", read.notices);
}

void joint_step(Client& client, const Json& request, std::string& out) {
  const bool has_twist = request.contains("linear") || request.contains("angular");
  if (has_twist == request.contains("increment")) {
    refuse("a 'joint_step' takes either 'linear' or 'angular' of the flange, or an 'increment'");
  }
  if (has_twist && request.contains("weights")) refuse("'weights' belong to an 'increment'");
  InstrumentConstraint& guarded = instrument_of(client);
  const auto joints = static_cast<std::size_t>(guarded.instrument().chain().size());
  for (const char* key : {"q", "increment", "weights"}) {
    if (request.contains(key) && request[key].size() != joints) {
      refuse(in_quotes(key) + " must have " + std::to_string(joints) +
             " numbers, one for each joint of the instrument");
    }
  }
  const std::vector<double> q = numbers(request, "q");
  const InstrumentStep step =
      has_twist ? guarded.step(q, twist_of(request))
                : guarded.step(q, numbers(request, "increment"), numbers(request, "weights"));
  append_joint_step(out, step, joints);
  if (guarded.mesh_count() > 1 && step.distance) {
    append_member(out, "nearest_mesh", step.nearest_mesh);
  }
  append_guides(out, client.instrument.guide_names, step.guides, step.relaxation);
}

/// Ignores the rule and the narrow phase of the service: a convex tool has its own.
void open_tool(Client& client, const Json& request, std::string& out) {
  MotionConstraintSettings settings = client.service.tip;
  settings.options.tool_radius = 0.0;
  settings.activation = "certified";
  settings.narrow_phase = request.value("narrow_phase", "exact");
  settings.tool = tool_of_text(request["tool"].get<std::string>());
  MotionConstraint made =
      make_motion_constraint(client.service.mesh, client.service.index, settings);
  if (client.tip.constraint) {
    made.set_guides(
        {client.tip.constraint->guides().begin(), client.tip.constraint->guides().end()});
  }
  client.tip.constraint = std::move(made);
  client.tool = request["tool"].get<std::string>();
  append_member(out, "ok", true);
}

void set_guides(Client& client, const Json& request, std::string& out) {
  const std::string of = request.value("of", "tip");
  if (of != "tip" && of != "instrument") refuse("'of' must be 'tip' or 'instrument'");
  std::vector<Guide> guides;
  for (const Json& text : request["guides"]) {
    guides.push_back(guide_of_text(text.get<std::string>()));
  }
  if (of == "instrument") {
    const auto of_base = std::ranges::find(guides, 0, &Guide::link);
    if (of_base != guides.end()) {
      throw Error("guide '" + of_base->name() +
                  "' is for a tip, or for the base: name a link, as in " +
                  std::string(guide_forms));
    }
    instrument_of(client);
    client.instrument.set_guides(std::move(guides));
  } else {
    if (!client.tip.constraint && !guides.empty()) {
      client.tip.constraint =
          make_motion_constraint(client.service.mesh, client.service.index, client.service.tip);
    }
    client.tip.set_guides(std::move(guides));
  }
  append_member(out, "ok", true);
}

AnatomicalSpace space_of(const Json& request, const char* key) {
  if (!request.contains(key)) return AnatomicalSpace::unstated;
  const std::string text = request[key].get<std::string>();
  if (const auto space = space_named(text)) return *space;
  throw Error(in_quotes(key) + " must be 'RAS' or 'LPS', not " + in_quotes(text));
}

LoadOptions load_options_of(const Json& request) {
  LoadOptions options{.space = space_of(request, "space"),
                      .untagged = space_of(request, "untagged"),
                      .unit = request.value("unit", ""),
                      .flip = request.value("flip", false)};
  if (request.contains("scale")) options.scale = request["scale"].get<double>();
  return options;
}

void add_anatomy(Client& client, const Json& request, std::string& out) {
  InstrumentConstraint& guarded = instrument_of(client);
  const LoadedMesh loaded = load_mesh(file_of(request, "file"), load_options_of(request));
  const std::shared_ptr<const Mesh>& mesh = loaded.mesh;
  const std::size_t number = guarded.add_mesh(mesh, make_or_load_index(mesh, client.service.tip),
                                              request.value("margin", 0.0));
  append_member(out, "ok", true);
  append_member(out, "mesh", number);
  append_member(out, "notices", loaded.notices);
  append_member(out, "warnings", loaded.warnings);
}

void place_anatomy(Client& client, const Json& request, std::string& out) {
  InstrumentConstraint& guarded = instrument_of(client);
  const std::size_t count = guarded.mesh_count();
  const double number = request["mesh"].get<double>();
  if (!(number >= 0.0 && number < static_cast<double>(count) && number == std::floor(number))) {
    throw Error("'mesh' must be the number of a mesh, 0 to " + std::to_string(count - 1) +
                ", not " + keepout::text_of(number));
  }
  const Status placed =
      guarded.place(static_cast<std::size_t>(number), frame_of(request), twist_of(request));
  if (!is_ok(placed)) {
    throw Error(
        "'frame', 'linear' or 'angular' is implausible beside the mesh: the mesh keeps its "
        "previous pose, and joint steps are invalid_input until it has a valid one");
  }
  append_member(out, "ok", true);
}

void info(Client& client, const Json&, std::string& out) {
  out.append(",").append(client.service.info);
  if (!client.tool.empty()) append_member(out, "tool", client.tool);
}

void statuses(Client& client, const Json&, std::string& out) {
  out.append(",").append(client.service.statuses);
}

void ping(Client&, const Json&, std::string& out) { append_member(out, "ok", true); }

}  // namespace

template <class Constraint>
void Guarded<Constraint>::set_guides(std::vector<Guide> guides) {
  std::vector<std::string> names;
  for (const Guide& guide : guides) names.push_back(guide.name());
  if (constraint) constraint->set_guides(std::move(guides));
  guide_names = std::move(names);
}

std::span<const Verb> verbs() {
  static const std::vector<Verb> verbs{
      {"step", {"tip", "desired"}, {"jacobian", "rows", "bounds"}, step},
      {"steps", {"motions"}, {}, steps},
      {"polytope", {"tip", "radius"}, {}, polytope},
      {"instrument", {"urdf"}, keys_of_instruments(), open_instrument, "no_instrument", most_work},
      {"joint_step", {"q"}, {"linear", "angular", "increment", "weights"}, joint_step},
      {"tool", {"tool"}, {"narrow_phase"}, open_tool, "no_tool", most_work},
      {"guides", {"guides"}, {"of"}, set_guides, "no_guide"},
      {"anatomy",
       {"file"},
       {"margin", "unit", "scale", "flip", "space", "untagged"},
       add_anatomy,
       "no_anatomy",
       most_work},
      {"place", {"mesh", "frame"}, {"linear", "angular"}, place_anatomy, "no_anatomy"},
      {"info", {}, {}, info},
      {"statuses", {}, {}, statuses},
      {"ping", {}, {}, ping}};
  return verbs;
}

}  // namespace keepout::app
