// SPDX-License-Identifier: BSD-3-Clause
#include "near_set.h"

#include <array>
#include <bit>
#include <set>

#include "gap.h"
#include "guards.h"
#include "keepout/geometry/separation.h"
#include "near_blocks.h"
#include "realtime/counted_allocations.h"

namespace keepout {
namespace {

// Cores of one, two and four points lie at random near a mesh. The listed triangles are compared
// with the gaps of all triangles, for growing distances, and in cycles that reuse the set.
TEST(NearSet, TellsAllThatIsNearOnceAndAllocatesNothing) {
  Random random(1);
  std::size_t listed_of = 0;
  for (const char* shape : {"cube", "gear"}) {
    const auto mesh = mesh_of(shape);
    Budget budget;
    Neighborhood near(mesh, std::make_shared<WideBvh>(mesh), mesh->triangle_count(), budget);
    for (const std::size_t points : {1u, 2u, 4u}) {
      const double width = points > 2 ? 1.0 : 0.0;
      NearSet set(near.room(), 2.0 * width);
      for (int i = 0; i < test::trials(200); ++i) {
        std::vector<Vec3> core{10.0 * random.direction()};
        if (points > 1) core.push_back(core[0] + 10.0 * random.uniform() * random.direction());
        while (core.size() < points) core.push_back(core[0] + width * random.direction());
        const double radius = random.uniform(0.0, 8.0);
        std::vector<double> distances;
        for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
          distances.push_back(gap(core, mesh->triangle(t)).distance);
        }
        const std::size_t before = allocations();
        ASSERT_TRUE(set.gather(near, core, radius, budget));
        ASSERT_EQ(allocations(), before);
        for (int cycle = 0; cycle < 3; ++cycle) {
          for (const double share : {0.1, 0.5, 0.9, 1.0}) {
            const std::size_t until = allocations();
            const std::span<NearTriangle> listed = set.nearer_than(share * radius, budget);
            for (NearTriangle& triangle : listed) set.measure(triangle, budget);
            ASSERT_EQ(allocations(), until) << shape;
            std::set<TriangleId> ids;
            for (const NearTriangle& triangle : listed) {
              ASSERT_TRUE(ids.insert(triangle.id).second) << "listed twice";
              ASSERT_LE(triangle.at_least, distances[triangle.id] + 1e-12);
              ASSERT_EQ(triangle.at_start.distance, distances[triangle.id]);
            }
            for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
              ASSERT_TRUE(distances[t] >= share * radius || ids.contains(t)) << shape << ' ' << t;
            }
            listed_of += ids.size();
          }
          set.start_listing(core);
        }
      }
    }
  }
  EXPECT_GT(listed_of, test::trials(20'000u));
}

// The time of a search with empty caches must be paid before triangles are read.
TEST(NearSet, ReadsNoCandidateThatTheBudgetDoesNotPay) {
  const auto mesh = mesh_of("gear");
  const std::vector<Vec3> core{Vec3::Zero()};
  const std::size_t all = mesh->triangle_count();
  const std::size_t needed = work::search + (all / 8) * work::collected + all * work::candidate;
  for (const std::size_t work_units : {std::size_t{1}, needed / 2, needed, needed + 1}) {
    Budget budget(work_units);
    Neighborhood near(mesh, std::make_shared<WideBvh>(mesh), all, budget);
    NearSet set(near.room(), 0.0);
    EXPECT_EQ(set.gather(near, core, 1e3, budget), work_units > needed) << work_units;
    EXPECT_EQ(set.radius() >= 0.0, work_units > needed) << work_units;
    EXPECT_EQ(set.size(), work_units > needed ? all : 0) << work_units;
  }
}

// Each triangle surrounds the foot of the perpendicular from the core, so the plane that the screen
// tries is the best one. Only the slack for rounding then keeps the triangle.
TEST(NearScreen, PassesOverNoTriangleWithinTheDistance) {
  Random random(1);
  int passed_over = 0;
  for (int trial = 0; trial < test::trials(5000); ++trial) {
    const Vec3 core = random.uniform(0.0, 1.0) * random.direction();
    const double size = std::pow(10.0, random.uniform(-0.5, 2.0));
    NearBlock block{};
    std::array<double, NearBlock::lanes> distances{};
    for (std::size_t lane = 0; lane < NearBlock::lanes; ++lane) {
      const Vec3 n = random.direction();
      const Vec3 along = size * n.unitOrthogonal();
      const Vec3 foot = core - n;
      const Triangle triangle{foot + along, foot - 0.5 * along + 0.8 * n.cross(along),
                              foot - 0.5 * along - 0.8 * n.cross(along)};
      block.set(lane, triangle, Vec3::Zero());
      distances[lane] = gap({&core, 1}, triangle).distance;
    }
    const double farthest = *std::max_element(distances.begin(), distances.end());
    const NearScreen tight(core, core, farthest * (1.0 + 1e-9), 2.0 * size + 2.0);
    ASSERT_EQ(may_be_near(block, tight), 0xffffu) << size;
    const NearScreen loose(core, core, 0.5, 2.0 * size + 2.0);
    passed_over += std::popcount(0xffffu & ~may_be_near(block, loose));
  }
  EXPECT_GT(passed_over, test::trials(10'000));
}

// The set of triangles near a body is reused in later cycles, as long as it has all triangles that
// the cycle needs.

// The ball is displaced from where its set was made, by 1 % more in each trial. A wall is just near
// enough to forbid the next motion. For some displacements the set does not contain the wall.
TEST(StaleNearSet, IsNotUsedWhereTheBodyHasMovedTooFar) {
  constexpr double radius = 1.0;
  const auto mesh = wall(0.0);
  const InstrumentOptions options{.damping = 0.0};
  const double kept = options.margin - options.band;
  for (const double motion : {0.01, 0.05, 0.1, 0.15}) {
    auto guard = guard_of(mesh, free_ball(radius), options);
    for (double way = 0.01; way < 20.0; way *= 1.01) {
      const double missing = 0.02 * way;
      const double start = way + radius + kept + motion - missing;  // from the wall
      guard.forget();
      std::vector<double> q{start, 0.0, 0.0};
      ASSERT_TRUE(guard.step(q, std::vector<double>(3, 0.0)).ok());
      q[0] -= way;
      if (q[0] < radius + options.margin) continue;
      const InstrumentStep step = guard.step(q, std::vector<double>{-motion, 0.0, 0.0});
      ASSERT_TRUE(step.ok()) << step.reason();
      ASSERT_GE(q[0] + step.increment[0] - radius, kept - 3.0 * guard.tolerance())
          << "after a displacement of " << way << " and a motion of " << motion;
    }
  }
}

Triangle random_triangle(Random& random) {
  const Vec3 at = 5.0 * random.direction();
  const double size = std::pow(10.0, random.uniform(-2.0, 1.0));
  const double width = std::pow(10.0, random.uniform(-6.0, 0.0));
  const Vec3 along = size * random.direction();
  return {at, at + along, at + random.uniform() * along + width * size * random.direction()};
}

double least_height(const std::vector<Vec3>& core, const Vec3& n) {
  double least = n.dot(core[0]);
  for (const Vec3& point : core) least = std::min(least, n.dot(point));
  return least;
}

// The reference searches planes and pairs of points. It shares only closest_point with gap().
TEST(Gap, IsTheDistanceOfTheHullAndProvenByItsPlane) {
  Random random(1);
  int touching = 0;
  for (int i = 0; i < test::trials(40'000); ++i) {
    const Triangle triangle = random_triangle(random);
    std::vector<Vec3> core;
    const std::size_t count = 1 + random.below(4);
    for (std::size_t p = 0; p < count; ++p) {
      core.push_back(5.0 * random.direction() * (random.below(4) == 0 ? 0.01 : 1.0));
    }
    const Gap found = gap(core, triangle);
    const Separation truth = separation(ConvexTool::hull(core), Vec3::Zero(), triangle);
    ASSERT_NEAR(found.distance, std::max(truth.distance, 0.0), 1e-11) << "trial " << i;
    if (!(found.distance > 0.0)) {
      ++touching;
      continue;
    }
    ASSERT_NEAR(found.normal.norm(), 1.0, 1e-14);
    const double behind = std::max({found.normal.dot(triangle[0]), found.normal.dot(triangle[1]),
                                    found.normal.dot(triangle[2])});
    ASSERT_LE(found.distance, least_height(core, found.normal) - behind + 1e-14);
    ASSERT_NEAR(found.normal.dot(found.contact) - behind, found.distance, 1e-6);
  }
  EXPECT_GT(touching, test::trials(100));
}

TEST(Gap, OfASegmentAlongATriangleIsSharp) {
  const Triangle triangle{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  for (const double tilt : {0.0, 1e-15, 1e-12, 1e-9, 1e-6}) {
    const std::vector<Vec3> core{Vec3(-100, 0.2, 0.5), Vec3(100, 0.3, 0.5 + 200.0 * tilt)};
    EXPECT_NEAR(gap(core, triangle).distance, 0.5 + 99.0 * tilt, 2e-12 + 3.0 * tilt) << tilt;
  }
}

TEST(Gap, OfWhatGoesThroughOrTouchesIsNone) {
  const Triangle triangle{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  for (const auto& [from, to] :
       {std::pair{Vec3(1, 1, -1), Vec3(1, 1, 3)}, std::pair{Vec3(1, 1, -50), Vec3(1, 1, 0)},
        std::pair{Vec3(-1, 1, 0), Vec3(5, 1, 0)}, std::pair{Vec3(0, 0, -1), Vec3(0, 0, 1)}}) {
    const std::vector<Vec3> core{from, to};
    EXPECT_EQ(gap(core, triangle).distance, 0.0);
    EXPECT_EQ(gap(core, triangle).normal, Vec3::Zero().eval());
  }
}

TEST(Gap, OfATriangleWithoutAnAreaIsThatOfItsSegment) {
  const Triangle segment{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1, 0, 0)};
  const Triangle point{Vec3(1, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 0)};
  const std::vector<Vec3> core{Vec3(1, -3, 2), Vec3(1, 3, 2)};
  EXPECT_NEAR(gap(core, segment).distance, 2.0, 1e-15);
  EXPECT_NEAR(gap(core, point).distance, 2.0, 1e-15);
}

}  // namespace
}  // namespace keepout
