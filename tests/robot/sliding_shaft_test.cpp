// SPDX-License-Identifier: BSD-3-Clause
// A shaft that slides through its remote centre while both of its ends move across.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "keepout/index/wide_bvh.h"
#include "keepout/robot/instrument_constraint.h"
#include "keepout/solvers/active_set.h"

namespace keepout {
namespace {

// The ends move on straight lines, and the shaft goes through the centre at the start and at the
// end of the motion. In between the guided place moves from one end to the other, off the centre by
// a quarter of what the ends move across, all told: that is in its slide alone.
TEST(SlidingShaft, IsKeptByItsRemoteCenterOnTheWholeMotion) {
  constexpr double length = 10.0;
  constexpr double across = 1.0;
  const auto mesh = std::make_shared<const Mesh>(
      Surface{{Vec3(0, 0, 500), Vec3(1, 0, 500), Vec3(0, 1, 500)}, {{0, 1, 2}}});
  const Joint insertion{.kind = JointKind::prismatic, .axis = Vec3::UnitX()};
  const Joint sideways{.kind = JointKind::prismatic, .axis = Vec3::UnitY()};
  const Instrument instrument(Chain({insertion, sideways, sideways}),
                              {{"end", {{3, Vec3(length, 0, 0)}}, 0.5}});
  const Guide port =
      Guide::remote_center("port", {2, Vec3::Zero()}, {3, Vec3(length, 0, 0)}, Vec3::Zero(), 0.1);
  const std::vector<double> q{0.0, 0.0, across};
  const std::vector<double> desired{-length, across, -2.0 * across};
  for (const double share : {1.0, 0.5, 0.1}) {
    SCOPED_TRACE(share);
    InstrumentConstraint guard(mesh, std::make_shared<WideBvh>(mesh), instrument,
                               std::make_unique<ActiveSet>(), {.check_sides = false});
    guard.set_guides({port});
    std::vector<double> asked = desired;
    for (double& number : asked) number *= share;
    const InstrumentStep step = guard.step(q, asked);
    ASSERT_TRUE(step.ok()) << step.reason();
    double most = 0.0;
    for (int s = 0; s <= 64; ++s) {
      std::vector<double> there = q;
      for (std::size_t k = 0; k < q.size(); ++k) there[k] += s / 64.0 * step.increment[k];
      ChainState chain;
      instrument.chain().place(there, chain);
      most = std::max(most, port.region().excess(port.place(chain)));
    }
    EXPECT_LE(most, port.band() + 3.0 * guard.tolerance());
    EXPECT_LT(step.increment[0], -0.01) << "and it moves";
  }
}

}  // namespace
}  // namespace keepout
