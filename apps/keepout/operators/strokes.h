// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "keepout/geometry/convex_tool.h"
#include "keepout/step/guide.h"
#include "simulate/audit.h"
#include "verify/robot/start.h"
#include "verify/setup.h"

namespace keepout::app {

struct StrokeSettings {
  std::uint64_t seed = 1;
  std::size_t count = 24;
  std::size_t cycles = 1000;  // of each stroke; 0: an instrument goes in and comes back once
};
inline constexpr double cycle_seconds = 0.001;

/// The motion of an operator with an instrument.
enum class Manner : std::uint8_t { push, lean, rotate };
inline constexpr std::array manners{Manner::push, Manner::lean, Manner::rotate};

/// A stroke of a simulated operator, who does not react to the guard: it is the same for every
/// guard.
struct Stroke {
  std::vector<Pose> goals = {};  // commanded poses of the tip or the flange, one a cycle
  // For an instrument only:
  Manner manner = Manner::push;
  double speed = 1.0;
  std::uint64_t number = 0;
  RobotStart start = {};
};

/// A smooth step from 0 to 1, at rest at both ends. The speed is continuous, the acceleration not.
inline double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Returns the depth of a stroke, from 0 to 1. The tool goes in during the first quarter of a
/// stroke and comes back during the last. `time`: from 0 to 1.
inline double lowered(double time) { return smooth(4.0 * time) * smooth(4.0 * (1.0 - time)); }

/// Returns a source of strokes of a tip: from free space to below the surface, along underneath it,
/// and back up, with a tremor. The source throws Error if no place is free.
///
/// Strokes go in where the surface faces outward, as seen from the middle of the mesh. If no such
/// place is free (a flat sheet, a mesh around the tool), they go in at any free place. They prefer
/// places whose start is within all guides. `tool`: a convex tool, which must be free as well; null
/// for a ball. `audit` and `tool` must outlive the source.
std::function<Stroke()> tip_strokes(Audit& audit, const StrokeSettings& settings,
                                    const ConvexTool* tool = nullptr,
                                    std::vector<Guide> guides = {});

/// Draws a stroke of an instrument. It comes from a port on the outside, 100 to 150 mm from the
/// surface, with its tip 5 to 20 mm before the surface (find_start). From there the operator goes
/// in and comes back, once in 400 / `speed` cycles, with a new draw each time.
///
/// The manner `push` moves the tip to 2 to 12 mm below the nearest place of the surface. There the
/// tip moves up to 20 mm to and fro along the surface. The manner `lean` does the same with the
/// axis of the shaft, about the port. It uses the place nearest to the surface on the shaft's last
/// half. It draws a dozen starts and takes the one whose shaft is nearest. A robot without a port
/// leans with the body before its tool, which moves as the tip does. The manner `rotate` brings the
/// tip to the surface, or up to 3 mm below. It turns the wrist by 0.5 to 1.2 rad to and fro about a
/// random axis. In the other strokes the turn is at most 0.2 rad.
///
/// The commanded position has a bias of up to 2 mm, drawn once for the stroke, and a tremor of 0.1
/// mm at 8 to 12 Hz. `number` determines the manner; the seed and `number` determine all else.
/// Throws Error if no start is found.
Stroke instrument_stroke(RobotScene& on, const StrokeSettings& settings, std::uint64_t number,
                         double speed);

}  // namespace keepout::app
