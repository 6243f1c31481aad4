// SPDX-License-Identifier: BSD-3-Clause
// Motions whose guided point is inside its region at both ends, and outside in between.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "guards.h"
#include "guide_kinematics.h"

namespace keepout {
namespace {

/// An instrument under one guide, far from a wall.
struct Guided {
  Guided(Instrument instrument, const Guide& its_guide)
      : guide(its_guide),
        mesh(wall(1e3)),
        guard(guard_of(mesh, std::move(instrument), {.damping = 0.0, .check_sides = false})) {
    guard.set_guides({guide});
  }

  /// Returns how far the guided point leaves its region on q + s dq, at 65 poses.
  double farthest_out(const std::vector<double>& q, std::span<const double> dq) const {
    double most = -1e30;
    for (int s = 0; s <= 64; ++s) {
      std::vector<double> there = q;
      for (std::size_t k = 0; k < dq.size(); ++k) there[k] += s / 64.0 * dq[k];
      ChainState chain;
      guard.instrument().chain().forward_kinematics(there, chain);
      most = std::max(most, guide.region().excess(guided_point(guide, chain)));
    }
    return most;
  }

  Guide guide;
  std::shared_ptr<const Mesh> mesh;
  InstrumentConstraint guard;
};

// The ends of the shaft move on straight lines. The shaft passes through the remote center at the
// start and at the end of the motion. In between the guided point slides from one end of the shaft
// to the other, and misses the center by a quarter of the sideways displacement of both ends.
TEST(GuidedPath, OfAShaftThatSlidesIsKeptInBetween) {
  constexpr double length = 10.0;
  const Joint insertion{.kind = JointKind::prismatic, .axis = Vec3::UnitX()};
  const Joint sideways{.kind = JointKind::prismatic, .axis = Vec3::UnitY()};
  const Instrument instrument(Chain({insertion, sideways, sideways}),
                              {{"end", {{3, Vec3(length, 0, 0)}}, 0.5}});
  const Guide port =
      Guide::remote_center("port", {2, Vec3::Zero()}, {3, Vec3(length, 0, 0)}, Vec3::Zero(), 0.1);
  const std::vector<double> q{0.0, 0.0, 1.0};
  for (const double share : {1.0, 0.5, 0.1}) {
    SCOPED_TRACE(share);
    Guided shaft(instrument, port);
    const std::vector<double> desired{-share * length, share, -2.0 * share};
    const InstrumentStep step = shaft.guard.step(q, desired);
    ASSERT_TRUE(step.ok()) << step.reason();
    EXPECT_LE(shaft.farthest_out(q, step.increment), port.band() + 3.0 * shaft.guard.tolerance());
    EXPECT_LT(step.increment[0], -0.01) << "the shaft moves";
  }
}

// For one revolute joint the second-derivative bound is exact. `missing` is the excess beyond the
// band in the middle of the arc, as a fraction of the sagitta.
TEST(GuidedPath, OfAPointThatTurnsIsKeptInTheMiddleOfItsArc) {
  constexpr double lever = 100.0;
  constexpr double turn = 0.04;
  const double sagitta = lever * (1.0 - std::cos(0.5 * turn));
  const LinkPoint point{1, Vec3(lever, 0, 0)};
  for (const double missing : {0.9, 0.45, 0.3, 0.01, -1e-3}) {
    SCOPED_TRACE(missing);
    const double band = 0.002;
    const Vec3 limit((lever - band - missing * sagitta), 0, 0);
    const Guide guide =
        Guide::point("limit", point, Region::half_space(limit, -Vec3::UnitX())).with_band(band);
    Guided arm({Chain({{.kind = JointKind::revolute}}), {{"point", {point}, 0.5}}}, guide);
    const std::vector<double> q{-0.5 * turn};
    const InstrumentStep step = arm.guard.step(q, std::vector<double>{turn});
    ASSERT_TRUE(step.ok()) << step.reason();
    EXPECT_LE(arm.farthest_out(q, step.increment), band + 3.0 * arm.guard.tolerance());
    EXPECT_EQ(step.increment[0] > (1.0 - 1e-9) * turn, missing < 0.0)
        << "the whole motion is made if it is clear";
  }
}

}  // namespace
}  // namespace keepout
