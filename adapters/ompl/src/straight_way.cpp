// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/ompl/straight_way.h"

#include <algorithm>
#include <cmath>

namespace keepout {
namespace {

/// Returns true if one step makes all of the motion. A recovery does not count, as the tip is too
/// close.
bool steps_to(MotionConstraint& guard, const Vec3& from, const Vec3& to) noexcept {
  const Vec3 desired = to - from;
  const Step step = guard.step({.tip = from, .desired = desired});
  return step.ok() && step.status != Status::recovering && step.motion == desired;
}

/// More than any planner needs. It bounds the time for a path of absurd length.
constexpr double most_pieces = 1e6;

/// The pieces of a path. Their ends are rounded by about 1e-16 of a coordinate. The distance
/// between pieces and straight line is a small part of the tau that the proof allows.
struct Pieces {
  Vec3 from;
  Vec3 to;
  double count;

  Vec3 at(double fraction) const noexcept {
    return fraction == 1.0 ? to : Vec3(from + fraction * (to - from));
  }
};

/// Proves one piece after another, as far as each can be proved. For the first unproven piece,
/// tries `halvings` parts of it. Does not test `from` itself.
ProvenPrefix proven_part(MotionConstraint& guard, const Vec3& from, const Vec3& to,
                         int halvings) noexcept {
  const double length = (to - from).norm();
  const Pieces pieces{from, to, std::max(1.0, std::ceil(length / guard.options().radius))};
  ProvenPrefix prefix{.fraction = 0.0, .end = from, .may_start = true};
  if (!(pieces.count <= most_pieces)) return prefix;
  const auto extend_to = [&](double fraction) {
    const Vec3 end = pieces.at(fraction);
    if (!steps_to(guard, prefix.end, end)) return false;
    prefix.fraction = fraction;
    prefix.end = end;
    return true;
  };
  for (double k = 1.0; k <= pieces.count; k += 1.0) {
    if (extend_to(k / pieces.count)) continue;
    double step = 0.5 / pieces.count;
    for (int i = 0; i < halvings; ++i) {
      // Equal fractions would mean no gain.
      if (prefix.fraction + step > prefix.fraction) extend_to(prefix.fraction + step);
      step *= 0.5;
    }
    break;
  }
  return prefix;
}

}  // namespace

bool keeps_margin(MotionConstraint& guard, const Vec3& point) noexcept {
  return steps_to(guard, point, point);
}

bool proves(MotionConstraint& guard, const Vec3& from, const Vec3& to) noexcept {
  return proven_part(guard, from, to, 0).whole();
}

ProvenPrefix proven_prefix(MotionConstraint& guard, const Vec3& from, const Vec3& to) noexcept {
  if (!keeps_margin(guard, from)) return {.end = from};
  return proven_part(guard, from, to, 8);
}

}  // namespace keepout
