// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>

#include "json_text.h"
#include "keepout/control/haptic_force.h"
#include "shared/clip.h"
#include "tool.h"

namespace {

using keepout::Vec3;

struct Tip final : Tool {
  Tip(Anatomy& of, std::string_view rule, const TipSettings& settings)
      : anatomy(of),
        spring{.stiffness = settings.stiffness, .largest_force = settings.largest_force},
        radius(settings.tool_radius),
        max_step(settings.max_step) {
    check(spring);
    facts = R"({"positions":3,"band":0,"period":0.001,"bodies":[{"name":"tool","radius":)" +
            keepout::web::json(radius) + "}]}";
    if (rule == "none") return;
    keepout::app::require_within_reach(max_step, settings.radius);
    constraint = anatomy.guard({.activation = std::string(rule),
                                .options = {.radius = settings.radius,
                                            .tool_radius = radius,
                                            .margin = settings.margin,
                                            .distances = keepout::Distances::always}});
  }

  void place(const double* positions) override {
    if (constraint) constraint->forget();
    move_to(Vec3(positions));
  }

  /// As `keepout replay --closed-loop`.
  void follow(const double* hand) override {
    const Vec3 goal(hand);
    step({.tip = tip, .desired = keepout::app::clipped(goal - tip, max_step)}, goal);
  }

  /// As `keepout replay`.
  void step(const double* asked) override {
    const keepout::Motion motion{.tip = Vec3(asked), .desired = Vec3(asked + 3)};
    step(motion, motion.tip + motion.desired);
  }

  double clearance(std::size_t) override { return anatomy.clearance(tip) - radius; }

  void step(const keepout::Motion& motion, const Vec3& hand) {
    keepout::Step step{.status = keepout::Status::free, .motion = motion.desired};
    if (constraint) step = constraint->step(motion);
    cycle.distance = step.distance.value_or(std::numeric_limits<double>::quiet_NaN());
    cycle.status = static_cast<std::uint32_t>(step.status);
    cycle.held = static_cast<std::uint32_t>(step.active.size());
    cycle.triangles = static_cast<std::uint32_t>(step.triangles);
    cycle.plane_count = static_cast<std::uint32_t>(step.planes.size());
    cycle.planes = step.planes.data();
    cycle.active = step.active.data();
    Eigen::Map<Vec3>(cycle.motion) = step.motion;
    Eigen::Map<Vec3>(cycle.asked) = hand;
    move_to(motion.tip + step.motion);
    const Vec3 stretch = tip - hand;
    const double length = stretch.norm();
    Eigen::Map<Vec3> force(cycle.force);
    force.setZero();
    if (constraint && length > 0.0) force = stretch * (spring.spring_force(length) / length);
  }

  void move_to(const Vec3& place) {
    tip = place;
    for (double* copy : {cycle.positions, cycle.flange, cycle.cores, cycle.cores + 3}) {
      Eigen::Map<Vec3>{copy} = tip;
    }
    cycle.flange[6] = 1.0;
  }

  Anatomy& anatomy;
  std::optional<keepout::MotionConstraint> constraint;  // none: the tip follows the hand anywhere
  keepout::SpringDamper spring;
  double radius, max_step;
  Vec3 tip = Vec3::Zero();
};

}  // namespace

std::unique_ptr<Tool> make_tip(Anatomy& anatomy, std::string_view rule,
                               const TipSettings& settings) {
  return std::make_unique<Tip>(anatomy, rule, settings);
}
