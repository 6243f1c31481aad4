// SPDX-License-Identifier: BSD-3-Clause
#include "live/instrument_start.h"

#include <cstdint>
#include <optional>

#include "keepout/error.h"

namespace keepout::app {
namespace {

constexpr std::uint64_t starts_tried = 64;

}  // namespace

RobotStart instrument_start(const std::string& mesh_name, const std::shared_ptr<const Mesh>& mesh,
                            const RobotUnderTest& robot, double margin) {
  Scene scene(mesh_name, mesh, "wide_bvh");
  const Box box = mesh->bounds();
  std::optional<RobotStart> first;
  for (std::uint64_t seed = 1; seed <= starts_tried; ++seed) {
    Random random(seed);
    auto start = find_start(scene, robot, Begin::apart, margin, random);
    if (!start) break;  // thousands of places were tried: there is no room
    const Vec3& port = start->base.position;
    if ((port.array() < box.low.array()).any() || (port.array() > box.high.array()).any()) {
      return *start;
    }
    if (!first) first = std::move(start);
  }
  if (!first) {
    throw Error(mesh_name + ": there is no room for the instrument of '" + std::string(robot.name) +
                "' before its surface: lower --margin");
  }
  return *first;
}

}  // namespace keepout::app
