// SPDX-License-Identifier: BSD-3-Clause
#include "serve/client.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include "keepout/error.h"
#include "keepout/factory/convex_tool_text.h"
#include "keepout/factory/guide_text.h"
#include "keepout/mesh/load_mesh.h"
#include "shared/names.h"
#if KEEPOUT_HAS_URDF
#include "keepout/urdf/read_chain.h"
#endif

namespace keepout::app {
namespace {

Vec3 vector(std::span<const double> numbers) { return {numbers[0], numbers[1], numbers[2]}; }

Pose pose_of(const NumberTable& frame) {
  if (!frame.is_given) return {};
  using RowByRow = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Eigen::Map<const RowByRow> m(frame.numbers.data());
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw Error("the last row of 'frame' must be 0, 0, 0, 1");
  }
  return {m.topRightCorner<3, 1>(), m.topLeftCorner<3, 3>()};
}

/// The four numbers of a link's number and a point of it.
LinkPoint link_point(std::span<const double> numbers) {
  const double link = numbers[0];
  if (!(link >= 0.0 && link <= Chain::most_joints && link == std::floor(link))) {
    throw Error("a link of 'capsules' is not a number from 0 to that of the last joint");
  }
  return {static_cast<int>(link), vector(numbers.subspan(1))};
}

Chain read_chain_of([[maybe_unused]] const Request& request) {
#if KEEPOUT_HAS_URDF
  const std::filesystem::path file(request.text("urdf").text);
  std::error_code trouble;
  // A pipe would hold up all clients.
  if (!std::filesystem::is_regular_file(file, trouble)) {
    throw Error("'urdf' must name a file, which " + in_quotes(request.text("urdf").text) +
                " does not");
  }
  const double scale = request.table("scale").is_given ? request.table("scale").numbers[0] : 1000.0;
  UrdfChain chain =
      read_chain(file, request.text("base_link").text, request.text("tip_link").text, scale);
  return Chain(std::move(chain.joints), pose_of(request.table("frame")), chain.flange);
#else
  throw Error(
      "this build reads no URDF: install liburdfdom-dev and liburdfdom-headers-dev, and build it "
      "anew");
#endif
}

Instrument instrument_of(const Request& request) {
  std::vector<Body> bodies;
  const std::span<const double> numbers = request.table("capsules").numbers;
  for (std::size_t i = 0; i < numbers.size(); i += 9) {
    const std::span<const double> row = numbers.subspan(i, 9);
    bodies.push_back({.points = {link_point(row), link_point(row.subspan(4))}, .radius = row[8]});
  }
  return {read_chain_of(request), std::move(bodies)};
}

InstrumentConstraint& instrument_of(Client& client) {
  if (client.instrument) return *client.instrument;
  throw Refusal{"no_instrument", "there is no instrument yet: open one, with 'instrument'"};
}

Twist twist_of(const Request& request) {
  Twist twist;
  if (request.table("linear").is_given) twist.linear = vector(request.table("linear").numbers);
  if (request.table("angular").is_given) twist.angular = vector(request.table("angular").numbers);
  return twist;
}

}  // namespace

void open_instrument(Client& client, const std::shared_ptr<const Mesh>& mesh,
                     const std::shared_ptr<const SpatialIndex>& index,
                     InstrumentConstraintSettings settings, const Request& request) {
  try {
    for (std::size_t i = 0; i < instrument_options.size(); ++i) {
      const OptionOfRequest& given = request.options[i];
      if (given.is_given) instrument_options[i].set(settings.options, given.value);
    }
    client.instrument = make_instrument_constraint(mesh, index, instrument_of(request), settings);
    client.guide_names.clear();
  } catch (const Error& error) {
    throw Refusal{"no_instrument", printable(error.what())};
  }
}

void open_tool(Client& client, const std::shared_ptr<const Mesh>& mesh,
               const std::shared_ptr<const SpatialIndex>& index, MotionConstraintSettings settings,
               const Request& request) {
  settings.options.tool_radius = 0.0;
  settings.activation = "certified";
  settings.narrow_phase =
      request.text("narrow_phase").is_given ? request.text("narrow_phase").text : "exact";
  try {
    settings.tool = tool_of_text(request.text("tool").text);
    MotionConstraint made = make_motion_constraint(mesh, index, settings);
    if (client.own) made.set_guides({client.own->guides().begin(), client.own->guides().end()});
    client.own = std::move(made);
  } catch (const Error& error) {
    throw Refusal{"no_tool", printable(error.what())};
  }
}

void set_guides(Client& client, const std::shared_ptr<const Mesh>& mesh,
                const std::shared_ptr<const SpatialIndex>& index,
                const MotionConstraintSettings& settings, const Request& request) {
  try {
    std::vector<Guide> guides;
    std::vector<std::string> names;
    for (const std::string& text : request.guides.texts) {
      guides.push_back(guide_of_text(text));
      names.push_back(guides.back().name());
    }
    if (request.text("of").text == "instrument") {
      const auto of_base = std::ranges::find(guides, 0, &Guide::link);
      if (of_base != guides.end()) {
        throw Error("guide '" + of_base->name() +
                    "' is of a tip, or of the base: name a link, as " + std::string(guide_forms));
      }
      instrument_of(client).set_guides(std::move(guides));
      client.guide_names = std::move(names);
      return;
    }
    if (!client.own && !guides.empty()) {
      client.own = make_motion_constraint(mesh, index, settings);
    }
    if (client.own) client.own->set_guides(std::move(guides));
    client.tip_guide_names = std::move(names);
  } catch (const Error& error) {
    throw Refusal{"no_guide", printable(error.what())};
  }
}

std::size_t add_anatomy(Client& client, const MotionConstraintSettings& settings,
                        const Request& request) {
  InstrumentConstraint& instrument = instrument_of(client);
  const std::filesystem::path file(request.text("file").text);
  try {
    std::error_code trouble;
    if (!std::filesystem::is_regular_file(file, trouble)) {
      throw Error("'file' must name a file, which " + in_quotes(request.text("file").text) +
                  " does not");
    }
    const std::shared_ptr<const Mesh> mesh = load_mesh(file).mesh;
    const OptionOfRequest& given = request.option("margin");
    const double margin = given.is_given ? std::get<double>(given.value) : 0.0;
    return instrument.add_mesh(mesh, make_or_load_index(mesh, settings), margin);
  } catch (const Error& error) {
    throw Refusal{"no_anatomy", printable(error.what())};
  }
}

void place_anatomy(Client& client, const Request& request) {
  InstrumentConstraint& instrument = instrument_of(client);
  const double number = request.table("mesh").numbers[0];
  const std::size_t count = instrument.mesh_count();
  if (!(number >= 0.0 && number < static_cast<double>(count) && number == std::floor(number))) {
    throw Refusal{"no_anatomy",
                  "'mesh' must be the number of a mesh, 0 to " + std::to_string(count - 1)};
  }
  try {
    const Status placed = instrument.place(static_cast<std::size_t>(number),
                                           pose_of(request.table("frame")), twist_of(request));
    if (is_ok(placed)) return;
  } catch (const Error& error) {
    throw Refusal{"no_anatomy", error.what()};
  }
  throw Refusal{"no_anatomy",
                "'frame', 'linear' or 'angular' is implausible beside the mesh: it keeps its "
                "previous pose, and joint steps are invalid_input until it has a valid one"};
}

InstrumentStep joint_step(Client& client, const Request& request) {
  InstrumentConstraint& instrument = instrument_of(client);
  const auto n = static_cast<std::size_t>(instrument.instrument().chain().size());
  for (const NumberTable* table :
       {&request.table("q"), &request.table("increment"), &request.table("weights")}) {
    if (table->is_given && table->columns != n) {
      throw Refusal{"not_a_request", in_quotes(table->name) + " must have " + std::to_string(n) +
                                         " numbers, one for each joint of the instrument"};
    }
  }
  if (request.table("increment").is_given) {
    return instrument.step(request.table("q").numbers, request.table("increment").numbers,
                           request.table("weights").numbers);
  }
  return instrument.step(request.table("q").numbers, twist_of(request));
}

}  // namespace keepout::app
