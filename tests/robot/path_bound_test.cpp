// SPDX-License-Identifier: BSD-3-Clause
// The certificate on motions for which its second-derivative bound is exact: no smaller bound is
// safe.
#include <gtest/gtest.h>

#include <cmath>

#include "guards.h"

namespace keepout {
namespace {

/// A point on an arm turns past a wall. It is nearest to the wall in the middle of the turn.
struct TurnPastAWall {
  static constexpr double lever = 100.0;
  static constexpr double turn = 0.04;
  static constexpr double radius = 0.5;

  /// `spare`: the distance in the middle beyond the certified one, as a fraction of the sagitta.
  /// `slide`: how far the arm's base slides back meanwhile, as a fraction of the chord.
  TurnPastAWall(double spare, double slide) {
    const InstrumentOptions options;
    const double due = radius + options.margin - options.band;
    const double sagitta = lever * (1.0 - std::cos(0.5 * turn));
    const double at = lever + due + spare * sagitta;
    const auto mesh = wall(at);
    const Joint base{.kind = JointKind::prismatic,
                     .axis = Vec3::UnitY(),
                     .limits = {.lower = -10.0, .upper = 10.0}};
    auto guard = guard_of(mesh,
                          {Chain({base, {.kind = JointKind::revolute}}),
                           {{"point", {{2, Vec3(lever, 0, 0)}}, radius}}},
                          options);
    const double chord = 2.0 * lever * std::sin(0.5 * turn);
    proof = guard.prove(std::vector<double>{0.0, -0.5 * turn},
                        std::vector<double>{-slide * chord, turn});
    const double nearest = at - due + 3.0 * guard.tolerance();
    clear_share = nearest < lever ? 0.5 - std::acos(nearest / lever) / turn : 1.0;
  }

  MotionProof proof;
  double clear_share;  // of the motion, until the point is nearer than the certified distance
};

// On the plain arc the separating planes decide. If the base slides back by the chord, the path
// ends where it begins: then the maximum displacement decides, and the ball about the start.
TEST(PathBound, AMotionWhoseMiddleComesTooNearIsNotCertifiedWhole) {
  for (const double slide : {0.0, 1.0}) {
    for (const double missing : {5e-4, 0.01, 0.1, 0.3, 0.45, 0.9}) {
      const TurnPastAWall past(-missing, slide);
      ASSERT_LT(past.clear_share, 0.5);
      EXPECT_LE(past.proof.share, past.clear_share) << slide << ' ' << missing;
    }
  }
}

TEST(PathBound, AMotionWhoseMiddleIsJustClearIsCertifiedWhole) {
  for (const double slide : {0.0, 1.0}) {
    for (const double spare : {1e-3, 0.1}) {
      EXPECT_TRUE(TurnPastAWall(spare, slide).proof.is_clear()) << slide << ' ' << spare;
    }
  }
}

}  // namespace
}  // namespace keepout
