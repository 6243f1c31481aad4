// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/ompl/straight_way.h"

#include <algorithm>
#include <cmath>

namespace keepout {
namespace {

/// One step makes the whole of it. A tip that is too close recovers, and none of that counts.
bool steps_to(MotionConstraint& guard, const Vec3& from, const Vec3& to) noexcept {
  const Vec3 desired = to - from;
  const Step step = guard.step({.tip = from, .desired = desired});
  return step.ok() && step.status != Status::recovering && step.motion == desired;
}

/// Halvings of the first piece that is not proven.
constexpr int halvings = 8;

/// More than any planner asks for; it bounds the time that a way of absurd length takes.
constexpr double most_pieces = 1e6;

/// The pieces of a way. Their ends are rounded, by some 1e-16 of a coordinate: the straight line
/// and the pieces are so much apart, which is a small part of the tau that the promise leaves.
struct Pieces {
  Vec3 from;
  Vec3 to;
  double count;

  double share(double end) const noexcept { return end / count; }
  Vec3 at(double share) const noexcept {
    return share == 1.0 ? to : Vec3(from + share * (to - from));
  }
};

Pieces cut(const MotionConstraint& guard, const Vec3& from, const Vec3& to) noexcept {
  const double length = (to - from).norm();
  return {from, to, std::max(1.0, std::ceil(length / guard.options().radius))};
}

}  // namespace

bool keeps_margin(MotionConstraint& guard, const Vec3& point) noexcept {
  return steps_to(guard, point, point);
}

bool proves(MotionConstraint& guard, const Vec3& from, const Vec3& to) noexcept {
  const Pieces pieces = cut(guard, from, to);
  if (!(pieces.count <= most_pieces)) return false;
  Vec3 start = from;
  for (double k = 1.0; k <= pieces.count; k += 1.0) {
    const Vec3 end = pieces.at(pieces.share(k));
    if (!steps_to(guard, start, end)) return false;
    start = end;
  }
  return true;
}

ProvenPrefix proven_prefix(MotionConstraint& guard, const Vec3& from, const Vec3& to) noexcept {
  ProvenPrefix prefix{.share = 0.0, .end = from, .may_start = keeps_margin(guard, from)};
  const Pieces pieces = cut(guard, from, to);
  if (!prefix.may_start || !(pieces.count <= most_pieces)) return prefix;
  const auto extend_to = [&](double share) {
    const Vec3 end = pieces.at(share);
    if (!steps_to(guard, prefix.end, end)) return false;
    prefix.share = share;
    prefix.end = end;
    return true;
  };
  for (double k = 1.0; k <= pieces.count; k += 1.0) {
    if (extend_to(pieces.share(k))) continue;
    double step = 0.5 / pieces.count;
    for (int i = 0; i < halvings; ++i) {
      // Equal shares would say that nothing was gained.
      if (prefix.share + step > prefix.share) extend_to(prefix.share + step);
      step *= 0.5;
    }
    break;
  }
  return prefix;
}

}  // namespace keepout
