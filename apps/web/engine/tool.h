// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <emscripten/val.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "anatomy.h"
#include "keepout/robot/instrument.h"
#include "keepout/step/guide.h"

/// Result of a control cycle: doubles in this order, which src/engine/keepout.ts reads.
struct Cycle {
  double positions[8];  // after the cycle: of a tip [mm], or of the joints [rad or mm]
  double motion[8];     // increment of the positions in the cycle
  double asked[6];  // of a tip: position of the hand [mm]; of a flange: motion [mm], rotation [rad]
  double
      flange[7];  // pose that follows the hand, after the cycle: position and quaternion i, j, k, w
  double force[3];  // of the spring between hand and tip, on the hand [N]
  // Distance of the tip, or the nearest body, from the surface before the cycle; NaN if unknown.
  // [mm]
  double distance = std::numeric_limits<double>::quiet_NaN();
  double status;        // a number of statuses()
  double held;          // planes or rows that limit the motion
  double rounds;        // judged trial motions of an instrument
  double nearest = -1;  // number of the nearest body; -1: unknown
  double triangles;     // examined by the step of a tip
  double plane_count;
  double by_mesh;  // 1 if the clearance from the mesh limits the motion
  double guides;   // bit g is set if guide g limits the motion
  // The largest distance of a guided point from its region before the cycle, below 0 inside; NaN
  // without guides. [mm, of an axis about rad]
  double excess = std::numeric_limits<double>::quiet_NaN();
  double cores[6 * keepout::Instrument::most_bodies];  // both ends of each body, after the cycle
};

/// A point of a body's core, and the point of the surface that is nearest to it. [mm]
struct Contact {
  keepout::Vec3 core;
  keepout::Vec3 surface;
};

/// A tool that follows a hand and that keepout constrains: the ball of a tip, or an instrument.
struct Tool {
  virtual ~Tool() = default;
  /// Sets the position of the tip or the joints, and resets all state.
  virtual void place(std::span<const double> positions) = 0;
  /// Runs one control cycle towards the hand. A tip ignores the orientation.
  virtual void follow(const keepout::Vec3& hand, const Eigen::Quaterniond& turn) = 0;
  /// Runs one step: of a tip from a position by an increment, of an instrument by a twist of the
  /// flange, which is its linear and its angular part.
  virtual void step(const keepout::Vec3& first, const keepout::Vec3& second) = 0;
  /// Returns the distance from the surface of a body to the mesh; NaN if it is unknown. It is below
  /// 0 if the body intersects the mesh; then it is the depth, without a limit if the mesh is
  /// watertight. For a body of an instrument it is accurate to 0.05 mm and a hundredth. [mm]
  virtual double clearance(std::size_t body) = 0;
  /// Returns where a body is nearest to the surface, or deepest in it; empty if it is unknown.
  virtual std::optional<Contact> contact(std::size_t) { return std::nullopt; }

  std::size_t positions = 3;  // numbers of a position
  std::size_t asked = 3;      // numbers of Cycle::asked
  double band = 0.0;          // curvature allowance [mm]
  double period = 0.001;      // of a cycle [s]
  std::vector<keepout::Body> bodies;
  keepout::LinkPoint end;  // the point that follows the hand
  std::vector<keepout::Guide> guides;
  Cycle cycle = {};
  std::span<const keepout::HalfSpace>
      planes;  // of the last step of a tip, relative to the tip before it
  std::span<const std::uint32_t> active;  // numbers of the planes that limit its motion
};

/// Makes the instrument of a robot: see make_tool().
std::unique_ptr<Tool> make_instrument(Anatomy& anatomy, const emscripten::val& settings);

/// Makes a tool with the settings that src/engine/keepout.ts declares. With a port it is the
/// instrument of a robot; without, it is the ball of a tip at the origin, with a rule. Throws
/// Error.
std::unique_ptr<Tool> make_tool(Anatomy& anatomy, const emscripten::val& settings);
