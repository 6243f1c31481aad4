// SPDX-License-Identifier: BSD-3-Clause
#include "keepout_rule.h"

#include <utility>

#include "keepout/factory/make_motion_constraint.h"

namespace keepout::peers {
namespace {

class KeepoutRule : public Rule {
 public:
  explicit KeepoutRule(MotionConstraint guard) : guard_(std::move(guard)) {}

  Vec3 step(const Vec3& tip, const Vec3& desired) override {
    return guard_.step({.tip = tip, .desired = desired}).motion;
  }

 private:
  MotionConstraint guard_;
};

}  // namespace

std::unique_ptr<Rule> keepout_rule(const Task& task, const std::string& activation) {
  MotionConstraintSettings settings;
  settings.activation = activation;
  settings.options.radius = task.radius;
  settings.options.margin = task.margin;
  settings.options.recovery = recovery;
  MotionConstraint guard = make_motion_constraint(task.index->shared_mesh(), task.index, settings);
  if (const auto& c = task.corridor) {
    guard.set_guides({Guide::point("corridor", Region::slab(c->point, c->normal, c->half_width))});
  }
  return std::make_unique<KeepoutRule>(std::move(guard));
}

}  // namespace keepout::peers
