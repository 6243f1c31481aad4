// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/ompl/projecting_steer.h"

#include <algorithm>

#include "keepout/error.h"
#include "keepout/ompl/straight_way.h"
#include "keepout/option_table.h"

namespace keepout {
namespace {

bool is_within(const Box& box, const Vec3& point) noexcept {
  return (point.array() >= box.low.array()).all() && (point.array() <= box.high.array()).all();
}

/// A long step that is limited loses more motion than short ones do. It is kept only if it comes
/// nearer to the target by this fraction of its length.
constexpr double good_gain = 0.5;

}  // namespace

ProjectingSteer::ProjectingSteer(MotionConstraint& guard, const SteerOptions& options)
    : guard_(&guard), options_(options) {
  const double radius = guard.options().radius;
  if (options_.sliding_step == 0.0) options_.sliding_step = radius / 8.0;
  if (!(options_.sliding_step > 0.0 && options_.sliding_step <= radius)) {
    throw Error("steer: sliding_step: expected a number above 0 and at most the radius " +
                text_of(radius) + " of its guard, got " + text_of(options_.sliding_step));
  }
  if (!(options_.least_gain >= 0.0 && options_.least_gain < 1.0)) {
    throw Error("steer: least_gain: expected a number from 0 to below 1, got " +
                text_of(options_.least_gain));
  }
  if (options_.most_steps == 0) throw Error("steer: most_steps: expected one at least, got 0");
}

ProjectingSteer::Way ProjectingSteer::steer(const Vec3& from, const Vec3& towards, double longest,
                                            const Box& bounds) {
  points_.assign(1, from);
  double length = 0.0;
  const auto ended = [&](Ending ending) { return Way{ending, points_, length}; };
  if (!towards.allFinite() || !is_within(bounds, from) || !keeps_margin(*guard_, from)) {
    return ended(Ending::not_free);
  }
  if (!(longest > 0.0)) return ended(Ending::length);  // also for NaN
  double longest_step = guard_->options().radius;
  for (std::size_t steps = 0; steps < options_.most_steps; ++steps) {
    const Vec3 tip = points_.back();
    const Vec3 to_go = towards - tip;
    const double remaining = to_go.norm();
    if (remaining == 0.0) return ended(Ending::arrived);
    const double wanted = std::min({longest_step, remaining, longest - length});
    if (!(wanted > 1e-9 * longest_step)) return ended(Ending::length);
    const bool is_last = wanted == remaining;
    const Vec3 desired = is_last ? to_go : Vec3(to_go * (wanted / remaining));
    const Step step = guard_->step({.tip = tip, .desired = desired});
    if (!step.ok() || step.status == Status::recovering) return ended(Ending::stuck);
    const bool is_free = step.motion == desired;
    const Vec3 next = is_free && is_last ? towards : Vec3(tip + step.motion);
    const double gain = remaining - (towards - next).norm();
    if (!is_free && longest_step > options_.sliding_step && gain < good_gain * wanted) {
      longest_step = options_.sliding_step;
      continue;
    }
    if (!(gain > options_.least_gain * wanted)) return ended(Ending::stuck);
    if (!is_within(bounds, next)) return ended(Ending::unbounded);
    length += (next - tip).norm();
    points_.push_back(next);
    if (is_free) longest_step = std::min(2.0 * longest_step, guard_->options().radius);
  }
  return ended(Ending::steps);
}

}  // namespace keepout
