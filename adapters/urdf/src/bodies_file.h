// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/geometry/pose.h"

namespace keepout {

/// The contents of a JSON file of bodies: docs/robots.md. Lengths are in mm.
struct BodiesFile {
  struct Point {
    std::string link;  // of the URDF
    Vec3 position;     // in the frame of the link [mm]
  };
  struct Entry {
    std::string name;
    std::vector<Point> points;
    double radius;  // [mm]
  };
  std::string base = {}, tip = {};  // links; empty if not stated
  Pose base_pose = {};              // of the base, in the frame of the mesh [mm]
  std::optional<std::vector<Entry>> bodies = std::nullopt;
};

constexpr std::size_t most_bytes_of_bodies = std::size_t{1} << 20;

/// Reads a text. Throws Error, which names the field and what to write, for a text that is not JSON
/// or has another form. Unknown and duplicate fields, and numbers that are not finite, are errors.
BodiesFile parse_bodies(std::string_view text);

}  // namespace keepout
