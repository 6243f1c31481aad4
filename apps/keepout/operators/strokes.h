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
  std::size_t cycles = 1000;  // of each stroke
};
inline constexpr double cycle_seconds = 0.001;

/// The motion of an operator with an instrument.
enum class Manner : std::uint8_t { push, lean, rotate };
inline constexpr std::array manners{Manner::push, Manner::lean, Manner::rotate};

/// A stroke of a simulated operator, who does not feel the guard: the same for whatever guards the
/// tool.
struct Stroke {
  std::vector<Pose> goals = {};  // where the operator wants the tip or the flange, cycle by cycle
  // Only for an instrument:
  Manner manner = Manner::push;
  double speed = 1.0;
  std::uint64_t number = 0;
  RobotStart start = {};
  Random random{0};  // for the judge
};

/// From 0 to 1, at rest at both ends: the speed is continuous, though the acceleration is not.
inline double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Returns how far the tool has gone in, from 0 to 1. It goes in during the first quarter of a
/// stroke and comes back during the last. `time`: from 0 to 1.
inline double lowered(double time) { return smooth(4.0 * time) * smooth(4.0 * (1.0 - time)); }

/// Returns a source of strokes of a tip: from free space to below the surface, along underneath it,
/// and back up, with a tremor. The source throws Error if no place is free.
///
/// Strokes go in where the surface faces outwards, as seen from the middle of the mesh, or, if that
/// is nowhere free (a flat sheet, a mesh that keeps the tool inside), at any free place. They
/// prefer places from which they start within all guides. `tool`: a convex tool, which must be free
/// as well; null for a ball. `audit` and `tool` must outlive the source.
std::function<Stroke()> tip_strokes(Audit& audit, const StrokeSettings& settings,
                                    const ConvexTool* tool = nullptr,
                                    std::vector<Guide> guides = {});

/// Draws a stroke of an instrument. It comes from a port on the outside, 100 to 150 mm from the
/// surface, its tip 5 to 20 mm before it (find_start). From there the operator goes in and comes
/// back, once in 400 / `speed` cycles, each time drawn anew:
/// - pushing moves the tip to 2 to 12 mm below the nearest place of the surface, and there up to
///   20 mm to and fro along it;
/// - leaning does so with the axis of the shaft: with the place on its last half that is nearest to
///   the surface, about the port; of a dozen starts it takes the one whose shaft is nearest;
/// - rotating brings the tip to the surface, or up to 3 mm below, and turns the wrist by 0.5 to 1.2
///   rad to and fro about any axis; in other strokes that is up to 0.2 rad.
///
/// The operator is off by a bias, up to 2 mm in a direction, drawn once for the stroke, and
/// trembles by 0.1 mm at 8 to 12 Hz. The manner follows from `number`; the rest is drawn from the
/// seed and `number`. Throws Error if no start is found.
Stroke instrument_stroke(RobotScene& on, const StrokeSettings& settings, std::uint64_t number,
                         double speed);

}  // namespace keepout::app
