// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "guard.h"

#include "keepout/factory/make_motion_constraint.h"
#include "setup.h"

namespace keepout::app {
namespace {

/// Options follow with each tip: at first any will do that are not refused.
MotionConstraintSettings any_settings(const Scene& scene) {
  const double radius = scene.mean_edge();
  return {.radius = radius,
          .margin = scene.longest_edge() + least_distance_kept(scene, radius),
          .capacity = {.nodes = most_nodes}};
}

}  // namespace

Guard::Guard(const Scene& scene)
    : constraint_(make_motion_constraint(scene.mesh(), scene.shared_index(), any_settings(scene))) {
}

void Guard::begin(const StepOptions& options, Inside inside) {
  constraint_.set_options(options);
  sides_ = inside == Inside::led_out ? constraint_.new_watch() : SideWatch();
}

Step Guard::step(const Motion& motion) noexcept { return constraint_.step(motion, sides_); }

}  // namespace keepout::app
