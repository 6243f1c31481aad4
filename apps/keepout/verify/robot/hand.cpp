// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/hand.h"

#include "shared/clip.h"

namespace keepout::app {
namespace {

constexpr std::size_t habit_lasts = 250;  // [cycles]
constexpr std::size_t attention = 10;     // it looks where the surface is as often [cycles]

}  // namespace

RobotHand::RobotHand(Scene& scene, Random& random, double speed)
    : scene_(&scene), random_(&random), speed_(speed) {}

Twist RobotHand::next(const Vec3& flange) {
  if (cycle_ % attention == 0) {
    const Hit hit = scene_->nearest(flange, guess_);
    guess_ = 1.1 * hit.closest.distance;
    if (hit.closest.distance > 0.0) inwards_ = hit.closest.offset / hit.closest.distance;
  }
  if (cycle_++ % habit_lasts == 0) {
    habit_ = static_cast<Habit>(random_->below(5));
    const double share = random_->uniform() < 0.5 ? 1.0 : random_->uniform(0.1, 1.0);
    way_ = share * speed_ * fastest_way;
    turn_ = share * speed_ * fastest_turn;
    heading_ = random_->direction();
    axis_ = random_->direction();
    goal_ = flange + (guess_ + random_->uniform(5.0, 40.0)) * inwards_;
  }
  switch (habit_) {
    case Habit::push:
      return {.linear = way_ * inwards_};
    case Habit::slide:
      return {.linear = clipped(way_ * (0.6 * inwards_ + heading_), way_)};
    case Habit::turn:
      return {.linear = 0.3 * way_ * inwards_, .angular = turn_ * axis_};
    case Habit::tremble:
      return {.linear = 0.5 * (clipped(goal_ - flange, way_) + way_ * random_->direction()),
              .angular = random_->uniform() * turn_ * random_->direction()};
    case Habit::go_behind:
      break;
  }
  return {.linear = clipped(goal_ - flange, way_), .angular = 0.25 * turn_ * axis_};
}

}  // namespace keepout::app
