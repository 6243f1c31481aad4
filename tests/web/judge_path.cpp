// SPDX-License-Identifier: BSD-3-Clause
// Judges a path that a page of `keepout live` has saved, and prints the verdict as JSON. The judges
// use nothing of the engine except its tolerance. [mm]
//
//     judge_path MESH STEPS.csv KEPT
//
// The exact oracle judges the path of a tip, as written by `keepout replay`. The verdict counts the
// motions, those that end inside, those that touch the mesh, and those that come nearer than KEPT
// minus 0.1 µm. It also has the least distance, or null if that is above KEPT + 0.1 mm.
//
//     judge_path MESH PATH
//
// The judge of campaigns judges the path of an instrument, with independent kinematics and
// distances. An open jaw is two bodies. The verdict counts the cycles, and those that begin
// elsewhere than the last one ended (jumps). It counts the cycles that come closer than margin -
// band, have the mesh in a body, or break joint limits. It has the least distance, the path length
// of the tip, and the largest turn of the jaw from its start [rad]. It also counts cycles near the
// surface that make less than half of the desired motion (held).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/error.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/index/index_cache.h"
#include "keepout/judges/robot_judge.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/oracle/safety_oracle.h"
#include "verify/robot/robots.h"

namespace {

using Json = nlohmann::json;
using keepout::Vec3;
using MeshPointer = std::shared_ptr<const keepout::Mesh>;

constexpr std::string_view mark = "# path: ";

/// Returns a length as JSON; null if it is infinite.
Json finite(double length) { return std::isfinite(length) ? Json(length) : Json(); }

Json judged_steps(const MeshPointer& mesh, std::istream& steps, double kept) {
  keepout::oracle::SafetyOracle oracle(mesh);
  std::string line;
  std::getline(steps, line);
  std::size_t motions = 0, inside = 0, crossing = 0, nearer = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (; std::getline(steps, line); ++motions) {
    std::istringstream columns(line);
    std::string word;
    double value[11] = {};  // step, status, p, d, u
    for (int i = 0; i < 11 && std::getline(columns, word, ','); ++i) {
      if (i != 1) value[i] = std::stod(word);
    }
    const Vec3 tip(value[2], value[3], value[4]);
    const Vec3 end = tip + Vec3(value[8], value[9], value[10]);
    const keepout::oracle::Finding finding =
        oracle.check(tip, end, std::max(kept - 1e-4, 0.0), kept + 0.1);
    crossing += finding.crosses ? 1 : 0;
    nearer += finding.below ? 1 : 0;
    nearest = std::min(nearest, finding.distance);
    inside += oracle.inside(end).value_or(false) ? 1 : 0;
  }
  if (motions == 0) throw keepout::Error("there is no motion");
  return {{"motions", motions},
          {"inside", inside},
          {"crossing", crossing},
          {"nearer", nearer},
          {"nearest", finite(nearest)}};
}

/// Returns the JSON in the head of a path, and leaves the stream after it.
Json head_of(std::istream& path) {
  for (std::string line; std::getline(path, line);) {
    if (line.starts_with(mark)) return Json::parse(line.substr(mark.size()));
  }
  throw keepout::Error("the path has no head");
}

keepout::Pose base_of(const Json& head) {
  const auto numbers = head.at("base").get<std::array<double, 12>>();
  keepout::Pose base;
  for (int i = 0; i < 3; ++i) {
    base.position[i] = numbers[i];
    for (int j = 0; j < 3; ++j) base.rotation(i, j) = numbers[3 + 3 * i + j];
  }
  return base;
}

/// Opens the jaw, the last body, by an angle: then it is two bodies. [deg]
void open_jaw(keepout::monitor::JudgedRobot& robot, double opening) {
  if (opening == 0.0) return;
  const keepout::monitor::JudgedBody jaw = robot.bodies.back();
  robot.bodies.pop_back();
  for (const double half : {-0.5, 0.5}) {
    const double angle = half * opening * std::numbers::pi / 180.0;
    const Vec3& end = jaw.points.back().position;
    robot.bodies.push_back(jaw);
    // The last joint turns about z.
    robot.bodies.back().points.back().position =
        Vec3(std::cos(angle) * end.x() - std::sin(angle) * end.y(),
             std::sin(angle) * end.x() + std::cos(angle) * end.y(), end.z());
  }
}

Json judged_path(const MeshPointer& mesh, std::istream& path) {
  const Json head = head_of(path);
  if (keepout::index_cache_file(*mesh, {}).stem().string() != head.at("digest")) {
    throw keepout::Error("the path is of another mesh");
  }
  const keepout::InstrumentOptions options{
      .margin = head.at("margin"), .band = head.at("band"), .period = head.at("period")};
  const auto& robot = keepout::app::robot_named(head.at("robot"));
  const keepout::Instrument instrument = robot.make(base_of(head));
  const double tolerance =
      keepout::make_instrument_constraint(mesh, instrument, {.options = options}).tolerance();
  keepout::monitor::JudgedRobot judged = robot.judged();
  open_jaw(judged, head.value("opening", 0.0));
  const auto tree = std::make_shared<const keepout::monitor::TriangleTree>(mesh);
  const std::size_t joints = static_cast<std::size_t>(instrument.chain().size());
  std::optional<keepout::oracle::RobotJudge> judge;
  std::vector<double> positions;
  Vec3 tip = Vec3::Zero(), first_way = Vec3::Zero();
  std::size_t cycles = 0, jumps = 0, below = 0, in_mesh = 0, limits = 0, held = 0;
  double nearest = std::numeric_limits<double>::infinity(), way = 0.0, turn = 0.0;
  const auto jaw_now = [&]() -> Vec3 {
    const keepout::monitor::Segment jaw = judge->axis(judged.bodies.size() - 1);
    return (jaw.to - jaw.from).normalized();
  };
  const auto tip_now = [&] { return judge->axis(judged.bodies.size() - 1).to; };
  for (std::string line; std::getline(path, line); ++cycles) {
    std::istringstream words(line);
    std::vector<double> numbers;
    for (std::string word; words >> word;) numbers.push_back(std::stod(word));
    if (numbers.size() != 2 * joints + 6) throw keepout::Error("a line of the path is cut off");
    const auto increment = numbers.begin() + static_cast<std::ptrdiff_t>(joints);
    const std::vector<double> from(numbers.begin(), increment);
    if (!judge) {
      judge.emplace(keepout::oracle::JudgedScene{judged, base_of(head), {{tree}}},
                    instrument.chain(), from, options, tolerance);
      tip = tip_now();
      first_way = jaw_now();
      positions = from;
    }
    jumps += from == positions ? 0 : 1;
    for (std::size_t k = 0; k < joints; ++k) positions[k] = from[k] + numbers[joints + k];
    const keepout::oracle::RobotVerdict verdict = judge->judge(positions);
    below += verdict.is_below ? 1 : 0;
    in_mesh += verdict.least < 0.0 ? 1 : 0;
    limits += verdict.limits_broken ? 1 : 0;
    nearest = std::min(nearest, verdict.least);
    const Vec3 made = tip_now() - tip;
    const Vec3 asked(numbers.data() + 2 * joints);
    const bool is_near = verdict.least <= options.margin;
    held += is_near && asked.norm() > 0.05 && made.dot(asked) < 0.5 * asked.squaredNorm() ? 1 : 0;
    way += made.norm();
    tip = tip_now();
    turn = std::max(turn, std::acos(std::clamp(jaw_now().dot(first_way), -1.0, 1.0)));
  }
  if (cycles == 0) throw keepout::Error("there is no cycle");
  return {{"cycles", cycles}, {"jumps", jumps},
          {"below", below},   {"in_mesh", in_mesh},
          {"limits", limits}, {"nearest", finite(nearest)},
          {"way", way},       {"turn", turn},
          {"held", held},     {"kept", options.margin - options.band}};
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3 && argc != 4) {
    std::cerr << "usage: judge_path MESH STEPS.csv KEPT, or judge_path MESH PATH\n";
    return EXIT_FAILURE;
  }
  const auto mesh = keepout::load_mesh(argv[1], {.check = keepout::MeshCheck::none}).mesh;
  std::ifstream file(argv[2]);
  std::cout << (argc == 4 ? judged_steps(mesh, file, std::stod(argv[3])) : judged_path(mesh, file))
            << '\n';
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "judge_path: " << error.what() << '\n';
  return EXIT_FAILURE;
}
