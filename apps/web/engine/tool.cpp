// SPDX-License-Identifier: BSD-3-Clause
#include "tool.h"

#include <limits>
#include <optional>
#include <string>

#include "keepout/control/haptic_force.h"
#include "shared/clip.h"
#include "tool_parts.h"

namespace {

using emscripten::val;
using keepout::Vec3;

struct Tip final : Tool {
  Tip(Anatomy& of, const val& settings)
      : anatomy(of),
        spring{.stiffness = number(settings, "stiffness"),
               .largest_force = number(settings, "largestForce")},
        max_step(number(settings, "maxStep")) {
    check(spring);
    const double radius = number(settings, "toolRadius");
    bodies = {{.name = "tool", .radius = radius}};
    const auto rule = settings["rule"].as<std::string>();
    if (rule == "none") return;
    keepout::app::require_within_reach(max_step, number(settings, "radius"));
    constraint = anatomy.guard({.activation = rule,
                                .options = {.radius = number(settings, "radius"),
                                            .tool_radius = radius,
                                            .margin = number(settings, "margin"),
                                            .distances = keepout::Distances::always}});
    guides = guides_of(settings);
    constraint->set_guides(guides);
  }

  void place(std::span<const double> start) override {
    if (constraint) constraint->forget();
    move_to(Vec3(start.data()));
  }

  /// As `keepout replay --closed-loop`.
  void follow(const Vec3& hand, const Eigen::Quaterniond&) override {
    make_step({.tip = tip, .desired = keepout::app::clipped(hand - tip, max_step)}, hand);
  }

  /// As `keepout replay`.
  void step(const Vec3& from, const Vec3& desired) override {
    make_step({.tip = from, .desired = desired}, from + desired);
  }

  double clearance(std::size_t) override {
    return anatomy.clearance(tip.x(), tip.y(), tip.z()) - bodies[0].radius;
  }

  void make_step(const keepout::Motion& motion, const Vec3& hand) {
    keepout::Step step{.status = keepout::Status::free, .motion = motion.desired};
    if (constraint) step = constraint->step(motion);
    planes = step.planes;
    active = step.active;
    show_limits(step, cycle);
    cycle.distance = step.distance.value_or(std::numeric_limits<double>::quiet_NaN());
    cycle.status = static_cast<double>(step.status);
    cycle.held = static_cast<double>(active.size());
    cycle.triangles = static_cast<double>(step.triangles);
    cycle.plane_count = static_cast<double>(planes.size());
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
  // Empty: the tip follows the hand without a guard.
  std::optional<keepout::MotionConstraint> constraint;
  keepout::SpringDamper spring;
  double max_step;
  Vec3 tip = Vec3::Zero();
};

}  // namespace

std::unique_ptr<Tool> make_tool(Anatomy& anatomy, const val& settings) {
  if (settings["port"].isNull()) return std::make_unique<Tip>(anatomy, settings);
  return make_instrument(anatomy, settings);
}
