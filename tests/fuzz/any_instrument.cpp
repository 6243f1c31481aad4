// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/any_instrument.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

namespace keepout::fuzz {
namespace {

Joint any_joint(Source& source) {
  Joint joint{.name = "joint",
              .kind = source.once_in(3) ? JointKind::prismatic : JointKind::revolute,
              .origin = any_pose(10.0, source),
              .axis = source.direction()};
  const double range = joint.kind == JointKind::prismatic ? 20.0 : 3.0;
  JointLimits& limits = joint.limits;
  // The position of a prismatic joint must be limited, unless the chain has no reach.
  if (joint.kind == JointKind::prismatic || source.once_in(2)) {
    limits.lower = -range * source.fraction();
    limits.upper = range * source.fraction();
  }
  if (source.once_in(2)) limits.velocity = range * source.magnitude(-2.0, 3.0);
  if (source.once_in(4)) limits.increment = range * source.magnitude(-4.0, 0.0);
  return joint;
}

Body any_body(int joints, Source& source) {
  Body body{.name = "body"};
  const std::size_t points = 1 + source.below(5);
  const auto link = static_cast<int>(source.below(static_cast<std::size_t>(joints) + 1));
  for (std::size_t i = 0; i < points; ++i) body.points.push_back({link, source.point(10.0)});
  if (points == 2 && source.once_in(2)) {  // a shaft through a port
    body.points[1].link = static_cast<int>(source.below(static_cast<std::size_t>(joints) + 1));
  }
  body.radius = source.once_in(4) ? 0.0 : source.between(0.0, 3.0);
  return body;
}

}  // namespace

Pose any_pose(double width, Source& source) {
  const double angle = source.once_in(2) ? 0.5 * std::numbers::pi * double(source.below(4))
                                         : source.between(-3.0, 3.0);
  return {source.point(width), Eigen::AngleAxisd(angle, source.direction()).toRotationMatrix()};
}

Instrument any_instrument(Source& source) {
  std::vector<Joint> joints;
  for (std::size_t k = 1 + source.below(7); k > 0; --k) joints.push_back(any_joint(source));
  const auto count = static_cast<int>(joints.size());
  std::vector<Body> bodies;
  for (std::size_t b = 1 + source.below(4); b > 0; --b) bodies.push_back(any_body(count, source));
  const Pose base = source.once_in(2) ? any_pose(30.0, source) : Pose{};
  return {Chain(std::move(joints), base, {source.point(10.0)}), std::move(bodies)};
}

InstrumentOptions any_instrument_options(Source& source) {
  InstrumentOptions options;
  options.margin = source.magnitude(-3.0, 0.7);
  options.band = options.margin * source.magnitude(-4.0, -0.3);
  options.period = source.magnitude(-4.0, -1.0);
  options.recovery = source.once_in(4) ? 0.0 : source.magnitude(-4.0, 0.0);
  options.slowing_within = source.once_in(4) ? source.magnitude(-2.0, 1.0) : 0.0;
  options.slowing_time = source.magnitude(-3.0, 0.0);
  options.damping = source.once_in(4) ? 0.0 : source.magnitude(-4.0, 1.0);
  options.orientation_weight = source.once_in(3) ? 0.0 : source.magnitude(-1.0, 2.0);
  options.refinements = static_cast<int>(source.below(4));
  options.check_sides = !source.once_in(3);
  return options;
}

}  // namespace keepout::fuzz
