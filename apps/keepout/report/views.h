// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "report/camera.h"
#include "report/image.h"
#include "report/tube.h"
#include "simulation_record.h"

namespace keepout::app {

/// The colour of each rule, and of where the tool must not be, in pictures and plots alike.
Rgb rule_color(std::size_t run);
inline constexpr Rgb alarm_color = {226, 16, 52};

/// The moment that tells most about the rules: the deepest penetration that a rule let happen, or
/// else a crossing, or else, as no rule failed, the worst of the run without a fixture.
struct Moment {
  std::size_t run = 0;
  std::size_t stroke = 0;
  std::size_t cycle = 0;
};
Moment telling_moment(const Simulation& simulation);

/// The deepest penetration of one run, or else its first crossing, or else its nearest approach.
Moment worst_moment(const Run& run, std::size_t number);

/// The same within one stroke: a cycle of it.
std::size_t worst_cycle(const Run& run, std::size_t stroke);

/// The whole anatomy with all strokes, from the side that shows most of them: one picture of the
/// anatomy, and for each run the paths as a transparent overlay of the same size.
struct Overview {
  Camera camera;
  Image anatomy;
  std::vector<Image> paths;
};
Overview overview(const Simulation& simulation, ImageSize size);

/// The stroke of the moment under one rule, the anatomy cut open along the path of the tip.
struct CloseUp {
  Camera camera;  // apart from the cut, the same for all rules
  Image picture;
  std::size_t worst = 0;  // cycle that the ball marks
};

/// One for each run.
std::vector<CloseUp> close_ups(const Simulation& simulation, const Moment& moment, ImageSize size);

}  // namespace keepout::app
