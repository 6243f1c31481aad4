// SPDX-License-Identifier: BSD-3-Clause
// A tip that is inside or too close recovers, and comes no deeper on its way.

#include <sstream>

#include "accuracy/certified_loop.h"

namespace keepout::test::certified_recovery {
namespace {

enum class Forbidden { inside, outside, nowhere };

struct Scene {
  const char* name;
  const char* shape;
  Forbidden forbidden;
  double margin;
  double recovery;
  std::size_t poses;
};

void PrintTo(const Scene& scene, std::ostream* out) { *out << scene.name; }

// A tip counts as recovered within this many tolerances of the margin, where no plane moves it.
constexpr double almost = 3.0;

/// Returns the best retreat from several surfaces: the maximum over all unit vectors of the least
/// component along `away`. It is the distance of the convex hull of `away` from the origin. Uses
/// Gilbert's algorithm; the returned value is attained.
double best_retreat(const std::vector<Vec3>& away) {
  Vec3 nearest = away.front();
  double best = -1.0;
  for (int i = 0; i < 300; ++i) {
    const double length = nearest.norm();
    if (length < 1e-9) break;
    const auto least = std::min_element(
        away.begin(), away.end(),
        [&](const Vec3& a, const Vec3& b) { return a.dot(nearest) < b.dot(nearest); });
    best = std::max(best, least->dot(nearest) / length);
    const Vec3 to = *least - nearest;
    if (to.squaredNorm() < 1e-24) break;
    nearest += std::clamp(-nearest.dot(to) / to.squaredNorm(), 0.0, 1.0) * to;
  }
  return best;
}

/// Signed distances from the oracle. The side is classified again only if a motion crosses the
/// surface.
class Side {
 public:
  Side(Loop& loop, const Vec3& tip, Forbidden forbidden) : loop_(&loop), forbidden_(forbidden) {
    ask(tip);
  }

  bool wrong() const { return wrong_; }

  void move(const Vec3& from, const Vec3& to) {
    if (forbidden_ != Forbidden::nowhere && loop_->oracle().check(from, to, 0.0).crosses) ask(to);
  }

  double signed_distance(const Vec3& tip) const {
    return wrong_ ? -loop_->distance(tip) : loop_->distance(tip);
  }

 private:
  void ask(const Vec3& tip) {
    if (forbidden_ == Forbidden::nowhere) return;
    wrong_ = loop_->oracle().inside(tip).value() == (forbidden_ == Forbidden::inside);
  }

  Loop* loop_;
  Forbidden forbidden_;
  bool wrong_ = false;
};

class CertifiedRecovery : public testing::TestWithParam<Scene> {
 protected:
  static MotionConstraintSettings settings() {
    return {.options = {.radius = 1.0,
                        .margin = GetParam().margin,
                        .recovery = GetParam().recovery,
                        .deepest = 1e3},
            .capacity = {.planes = 200}};
  }

  static std::vector<Vec3> poses(Loop& loop, Random& random) {
    const Scene& scene = GetParam();
    std::vector<Vec3> out;
    while (out.size() < scene.poses) {
      // In a solid, half of the tips are too close, and half are anywhere inside.
      const double offset =
          random.uniform(scene.forbidden == Forbidden::nowhere ? -1.0 : -3.0, 1.0) * scene.margin;
      const Vec3 near = surface_points(loop.mesh(), 1, offset, random)[0];
      if (loop.distance(near) < 3.0 * scene.margin) out.push_back(near);
      if (scene.forbidden != Forbidden::inside) continue;
      const Vec3 place = random_points(loop.mesh(), 1, random)[0];
      if (loop.oracle().inside(place).value()) out.push_back(place);
    }
    return out;
  }

  /// Returns best_retreat() from all triangles within the margin of a tip; 1 without any.
  static double room_left(Loop& loop, const PdTree& tree, TriangleBuffer& near, const Vec3& tip) {
    near.clear();
    const double within = loop.margin() + 4.0 * loop.tolerance(tip);
    tree.collect({tip, within}, near);
    std::vector<Vec3> away;
    for (const TriangleId t : near) {
      const ClosestPoint closest = closest_point(loop.mesh().triangle(t), tip);
      if (closest.distance < within && closest.distance > 0.0) {
        away.push_back(-closest.offset.normalized());
      }
    }
    return away.empty() ? 1.0 : best_retreat(away);
  }

  void recover(double desired_length) {
    const Scene& scene = GetParam();
    Loop loop(make_shape(scene.shape), settings());
    const PdTree tree(loop.shared_mesh());
    TriangleBuffer near(loop.mesh().triangle_count());
    Random random(3);
    double slowest = 0.0;  // to 99.9 % of the margin
    std::size_t stuck = 0, odd = 0, narrow = 0;
    std::ostringstream oddities;
    for (const Vec3& start : poses(loop, random)) {
      Vec3 tip = start;
      Side side(loop, tip, scene.forbidden);
      double before = side.signed_distance(tip);
      const double due = (scene.margin - before) / scene.recovery;
      // Between two walls, a cycle gains only a fraction of the distance that is missing.
      const auto most = static_cast<int>(2.0 * due) + 400;
      int cycle = 0, all_but_out = 0, idle = 0;
      for (; cycle < most; ++cycle) {
        if (before >= scene.margin - almost * loop.tolerance(tip)) break;
        if (before < 0.999 * scene.margin) all_but_out = cycle + 1;
        const Vec3 desired = desired_length * random.uniform() * random.direction();
        const Step step = loop.step(tip, desired);
        const double tau = loop.tolerance(tip);
        const bool borderline =
            before >= scene.margin - 3.01 * tau || std::abs(before) <= 4.01 * tau;
        if (step.status != Status::recovering && !borderline) {
          ++odd;
          if (odd < 4) {
            oddities << name(step.status) << " at " << tip.transpose() << ", distance " << before
                     << ", desired " << desired.transpose() << "; ";
          }
        }
        const Vec3 next = tip + step.motion;
        side.move(tip, next);
        const double after = side.signed_distance(next);
        ASSERT_GE(after, std::min(before, scene.margin) - 3.0 * tau)
            << "from " << tip.transpose() << " by " << step.motion.transpose();
        const bool still = step.motion.norm() <= loop.tolerance(tip);
        tip = next;
        before = after;
        if (still && desired_length == 0.0 && ++idle > 3) break;
      }
      if (before >= scene.margin - almost * loop.tolerance(tip)) {
        slowest = std::max(slowest, all_but_out - due);
        continue;
      }
      // A tip may stop only if each direction approaches a triangle that is already too close.
      const double room = side.wrong() ? 1.0 : room_left(loop, tree, near, tip);
      if (room < 0.05) {
        ++narrow;
      } else {
        ++stuck;
        oddities << "stuck at " << tip.transpose() << " from " << start.transpose() << ", "
                 << (scene.margin - before) / loop.tolerance(tip) << " tolerances short, room "
                 << room << "; ";
      }
    }
    EXPECT_EQ(stuck, 0u) << oddities.str();
    EXPECT_EQ(odd, 0u) << "not recovering: " << oddities.str();
    // A tip leaves a narrow fold along the fold. Between walls that are too close together, only
    // the desired motions move it out.
    if (scene.margin <= 0.5) {
      EXPECT_LE(slowest, 120.0) << "cycles beyond depth by recovery";
    }
    EXPECT_EQ(narrow > 0, scene.margin > 0.5) << "gaps narrower than two margins";
  }
};

TEST_P(CertifiedRecovery, WithoutADesireTheTipGetsOut) { recover(0.0); }

TEST_P(CertifiedRecovery, AgainstDesiresTheTipGetsOut) { recover(0.6); }

using enum Forbidden;

INSTANTIATE_TEST_SUITE_P(
    Shapes, CertifiedRecovery,
    testing::Values(Scene{"cube", "cube", inside, 0.3, 0.5, 600},
                    Scene{"sphere", "sphere", inside, 0.3, 0.5, 600},
                    Scene{"gear", "gear", inside, 0.3, 0.2, 600},
                    Scene{"star_bumps", "star_bumps", inside, 0.3, 0.3, 500},
                    Scene{"cortex", "cortex", inside, 0.3, 0.3, 600},
                    Scene{"concave_sphere", "concave_sphere", outside, 0.3, 0.1, 400},
                    Scene{"thin_plates", "thin_plates", inside, 0.3, 0.1, 400},
                    Scene{"narrow_gaps", "thin_plates", inside, 0.7, 0.1, 200},
                    Scene{"saddle_terrain", "saddle_terrain", nowhere, 0.3, 0.1, 400},
                    Scene{"crown", "crown", nowhere, 0.3, 0.1, 400},
                    Scene{"flat_plate", "flat_plate", nowhere, 0.3, 0.1, 300},
                    Scene{"non_manifold", "non_manifold", nowhere, 0.3, 0.1, 300},
                    Scene{"far_cube", "far_cube", inside, 0.3, 0.5, 300}),
    by_name);

TEST(CertifiedRecoveryInAGap, NarrowerThanTwoMarginsIsHonest) {
  // The plates and the gaps between them are 1 thick. With a margin of 0.7, the only way out is
  // through the sides.
  Loop loop(make_shape("thin_plates"),
            {.options = {.radius = 1.0, .margin = 0.7, .recovery = 0.1}});
  const Box& bounds = loop.mesh().bounds();
  Vec3 tip(3.0, 4.0, bounds.low.z() + 1.4);
  double before = loop.distance(tip);
  for (int cycle = 0; cycle < 100; ++cycle) {
    const Step step = loop.step(tip, Vec3::Zero());
    ASSERT_EQ(step.status, Status::recovering);
    const Vec3 next = tip + step.motion;
    const double after = loop.distance(next);
    ASSERT_GE(after, before - 3.0 * loop.tolerance(tip));
    tip = next;
    before = after;
  }
  EXPECT_LT(before, 0.7) << "no place in the gap has this clearance";
}

TEST(CertifiedRecoveryInAGap, OfMoreThanTwoMarginsItsMiddleIsFound) {
  Loop loop(make_shape("thin_plates"),
            {.options = {.radius = 1.0, .margin = 0.49, .recovery = 0.1}});
  const Box& bounds = loop.mesh().bounds();
  for (const double height : {1.05, 1.3, 1.5, 1.95}) {
    Vec3 tip(3.0, 4.0, bounds.low.z() + height);
    for (int cycle = 0; cycle < 20; ++cycle) tip += loop.step(tip, Vec3::Zero()).motion;
    EXPECT_GE(loop.distance(tip), 0.49 - 3.0 * loop.tolerance(tip)) << "from " << height;
  }
}

TEST(CertifiedRecoverySide, AnInsideOutMeshIsLedOutOfOnItsOwnFreeSide) {
  // The free side is inside, the forbidden side is outside.
  Loop loop(make_shape("concave_sphere"),
            {.options = {.radius = 1.0, .margin = 0.3, .recovery = 0.5, .deepest = 1e3}});
  Vec3 tip(0.0, 0.0, 53.0);
  for (int cycle = 0; cycle < 12; ++cycle) {
    const Step step = loop.step(tip, Vec3(0.0, 0.0, 0.5));
    if (tip.norm() >= 50.0) {
      ASSERT_EQ(step.status, Status::recovering);
    } else if (cycle == 11) {
      ASSERT_EQ(step.status, Status::limited);
    }
    tip += step.motion;
  }
  EXPECT_TRUE(loop.oracle().inside(tip).value());
}

TEST(CertifiedRecoverySide, ATipThatIsTakenAsItIsStaysOnItsSide) {
  Loop loop(make_shape("sphere"), {.options = {.radius = 1.0, .margin = 0.3, .recovery = 0.5},
                                   .inside = Inside::taken_as_is});
  Vec3 tip(0.0, 0.0, 45.0);
  Random random(4);
  for (int cycle = 0; cycle < 500; ++cycle) {
    const Step step = loop.step(tip, Vec3(0.0, 0.0, 0.6) + 0.3 * random.direction());
    ASSERT_LE(loop.loss(tip, tip + step.motion), 3.0);
    tip += step.motion;
  }
  EXPECT_TRUE(loop.oracle().inside(tip).value());
  EXPECT_LT(loop.distance(tip), 0.4) << "in contact from within";
}

// A tip that is too close retreats by at least one tolerance per cycle, even if `recovery` is
// smaller. Otherwise the rounding losses of the cycles would accumulate.

TEST(LeastRetreat, IsATolerance) {
  Random random(9);
  for (const double recovery : {0.0, 1e-15, 1e-12}) {
    for (const char* shape : {"cube", "sphere", "gear"}) {
      SCOPED_TRACE(testing::Message() << shape << ", recovery " << recovery);
      Loop loop(make_shape(shape),
                {.options = {.radius = 1.0, .margin = 0.5, .recovery = recovery}});
      for (const Vec3& tip : places(loop, 5, 0.3, random)) {
        const Step step = loop.step(tip, Vec3::Zero());
        ASSERT_EQ(step.status, Status::recovering);
        EXPECT_GE(step.motion.norm(), 0.99 * loop.tolerance(tip));
        EXPECT_GT(loop.distance(tip + step.motion), loop.distance(tip));
      }
    }
  }
}

}  // namespace
}  // namespace keepout::test::certified_recovery
