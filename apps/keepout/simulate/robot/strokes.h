// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "verify/robot/start.h"

namespace keepout::app {

/// What an operator does with an instrument.
enum class Manner : std::uint8_t { push, lean, rotate };
inline constexpr std::array manners{Manner::push, Manner::lean, Manner::rotate};
/// "pushing with the jaw", ...
std::string_view name(Manner manner) noexcept;

/// A stroke, the same for whatever guards the instrument.
struct RobotStroke {
  Manner manner = Manner::push;
  RobotStart start;
  std::vector<Pose> hand;  // where it would have the flange, cycle by cycle
};

/// A stroke of an operator who does not feel the guard. The instrument comes from a port on the
/// outside, 100 to 150 mm from the surface, its tip 5 to 20 mm before it (find_start). From there
/// the operator goes in and comes back to where it began, once in 400 / `speed` cycles, each time
/// drawn anew:
/// - pushing moves the tip to 2 to 12 mm below the nearest place of the surface, and there up to
///   20 mm to and fro along it;
/// - leaning does so with the axis of the shaft: with the place on its last half that is nearest to
///   the surface, about the port; of a dozen starts it takes the one whose shaft is nearest;
/// - rotating brings the tip to the surface, or up to 3 mm below, and turns the wrist by 0.5 to 1.2
///   rad to and fro about any axis; in other strokes that is up to 0.2 rad.
///
/// The hand is off by a bias, up to 2 mm in a direction, drawn once for the stroke, and it trembles
/// as that of `simulate` does, by 0.1 mm at 8 to 12 Hz. All of it is drawn from `random`, and from
/// nothing else: the same seed gives the same strokes. None where no start is found.
std::optional<RobotStroke> make_robot_stroke(RobotScene& on, Manner manner, double speed,
                                             std::size_t cycles, Random& random);

}  // namespace keepout::app
