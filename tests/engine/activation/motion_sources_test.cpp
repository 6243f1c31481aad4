// SPDX-License-Identifier: BSD-3-Clause
// Compares the sources of triangles that indices offer: the traversal of a WideBvh, and all hits of
// a query. The certified rule must give bitwise identical results with both.

#include "engine/activation/sources.h"
#include "index/wide_bvh/traversal/tree_traversal.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/motion_traversal.h"
#include "keepout/index/query.h"
#include "trials.h"

namespace keepout {
namespace {

/// Lengths as fractions of the size of the mesh.
struct Scale {
  double margin;
  double motion;
};
constexpr Scale scales[] = {{0.005, 0.003}, {0.001, 0.02}, {0.03, 0.002}, {0.02, 0.1}};

/// Moves a tip as an operator does who presses and drags. The tips start clear, too close, on the
/// surface or inside. Each moves by the result of `ask`.
template <class Ask>
void drag(Sources& sources, const Scale& scale, std::size_t strokes, Ask&& ask) {
  const double size = sources.mesh->bounds().size().norm();
  const double margin = scale.margin * size;
  const double motion = scale.motion * size;
  const PdTree nearby(sources.mesh);
  NearestTriangle nearest(*sources.mesh, nearby);
  Random random(7);
  for (const double offset : {1.5 * margin, 0.3 * margin, 0.0, -0.5 * margin}) {
    for (const Vec3& start : surface_points(*sources.mesh, strokes, offset, random)) {
      Vec3 tip = start;
      Vec3 press = random.direction();
      for (int cycle = 0; cycle < 12; ++cycle) {
        if (cycle % 4 == 0) {
          const Vec3 way = nearest(tip).closest.offset;
          press = way.norm() > 0.0 ? Vec3(way.normalized()) : random.direction();
        }
        const Vec3 desired =
            random.uniform(0.2, 1.0) * motion * (press + random.direction()).normalized();
        tip += ask(Motion{.tip = tip, .desired = desired}, margin, motion);
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

class SourcesOn : public ::testing::TestWithParam<std::string> {};

TEST_P(SourcesOn, AgreeBitForBitOnEachTarget) {
  Sources sources(make_shape(GetParam()));
  Budget budget;
  ASSERT_NE(sources.tree->traverse_along_motions(budget), nullptr);
  std::vector<Outcome> on_the_first;
  on_each_simd_target([&] {
    std::vector<Outcome> made;
    for (const Scale& scale : scales) {
      drag(sources, scale, 4, [&](const Motion& motion, double margin, double length) {
        const StepOptions options{
            .radius = 1.1 * length, .margin = margin, .recovery = 0.2 * margin};
        made.push_back(sources.asking(motion, options));
        EXPECT_EQ(sources.traversing(motion, options), made.back())
            << motion.tip.transpose() << " by " << motion.desired.transpose();
        return made.back().motion;
      });
    }
    if (on_the_first.empty()) on_the_first = made;
    EXPECT_TRUE(made == on_the_first);
  });
  const auto count = [&](Status status) {
    return std::ranges::count(on_the_first, status, &Outcome::status);
  };
  EXPECT_GT(count(Status::limited), 50);
  EXPECT_GT(count(Status::recovering), 20);
}

INSTANTIATE_TEST_SUITE_P(Shapes, SourcesOn, ::testing::ValuesIn(names_of_shapes()), by_name);

TEST(SourcesWithOptions, AgreeBitForBitWithJointsAndRowsOnEachTarget) {
  Sources sources(make_shape("cortex"));
  const TipJacobian::Matrix jacobian = [] {
    TipJacobian::Matrix j(3, 5);
    j << 1, 0, 0, 0.5, -0.3, 0, 1, 0, 0.2, 0.7, 0, 0, 1, -0.4, 0.1;
    return j;
  }();
  const std::vector<double> matrix{1, 0, 0, -1, 0, 0}, bounds{-0.001, -0.5};
  std::size_t limited = 0;
  const auto ask_on = [&](const Scale& scale) {
    drag(sources, scale, 6, [&](const Motion& motion, double margin, double length) {
      StepOptions options{.radius = 1.5 * length, .margin = margin};
      Vec3 way = Vec3::Zero();
      for (int variant = 0; variant < 5; ++variant) {
        Motion asked = motion;
        options.refinements = variant == 1 ? 0 : 3;
        options.nodes = variant == 2 ? 12 : 0;
        options.query = variant == 3 ? Query::sphere : Query::motion;
        options.damping = 0.0;
        if (variant == 3) asked.rows = ExtraRows(matrix.data(), bounds.data(), 2);
        if (variant == 4) {
          asked.jacobian = TipJacobian(jacobian);
          options.damping = 1e-3;
        }
        const Outcome expected = sources.asking(asked, options);
        EXPECT_EQ(sources.traversing(asked, options), expected) << "variant " << variant;
        limited += expected.status == Status::limited;
        if (variant == 0) way = expected.motion;
      }
      return way;
    });
  };
  on_each_simd_target([&] {
    for (const Scale& scale : {scales[0], scales[1]}) ask_on(scale);
  });
  EXPECT_GT(limited, 100u);
}

TEST(TreeTraversalMemory, DoesNotChangeAnswers) {
  Sources sources(make_shape("star_bumps"));
  std::size_t limited = 0;
  drag(sources, scales[0], 10, [&](const Motion& motion, double margin, double length) {
    const StepOptions options{.radius = 1.1 * length, .margin = margin};
    const Outcome remembered = sources.traversing(motion, options);
    const auto fresh = guard(sources.mesh, sources.tree, options);
    EXPECT_EQ(Outcome(fresh->step(motion)), remembered);
    limited += remembered.status == Status::limited;
    return remembered.motion;
  });
  EXPECT_GT(limited, 50u);
}

/// The padding of the cached region must not grow until large boxes stay unopened. Each cycle would
/// examine these boxes, and the region would cover all later queries, so nothing would replace it.
TEST(TreeTraversalMemory, IsOfLeavesHoweverManyStrokesThereWere) {
  const auto mesh = mesh_of("cortex");
  const auto tree = std::make_shared<WideBvh>(mesh);
  const PdTree nearby(mesh);
  NearestTriangle nearest(*mesh, nearby);
  const double size = mesh->bounds().size().norm();
  const StepOptions options{.radius = 2e-3 * size, .margin = 2e-3 * size};
  const auto constraint = guard(mesh, tree, options);
  Budget unlimited;
  TreeTraversal traversal(tree->tree(), unlimited);
  Random random(3);
  int limited = 0, unopened = 0;
  for (Vec3 tip : surface_points(*mesh, 300, 1.2 * options.margin, random)) {
    const Vec3 along = random.direction();
    for (int cycle = 0; cycle < 20; ++cycle) {
      const Vec3 way = nearest(tip).closest.offset.normalized() + along;
      const Vec3 desired = 0.5 * options.radius * way.normalized();
      const Ball region{tip + 0.5 * desired, 0.5 * desired.norm() + options.margin};
      ASSERT_TRUE(traversal.begin({tip, region, options.margin, desired.norm()}));
      const Step made = constraint->step({.tip = tip, .desired = desired});
      limited += made.status == Status::limited;
      unopened += traversal.cache().is_opened() ? 0 : 1;
      tip += made.motion;
    }
  }
  EXPECT_GT(limited, 3000);
  EXPECT_LT(unopened, 60);  // 1 % of the cycles, when a padding was tried that was too large
}

TEST(MotionTraversal, IsOfferedByWideBvhAndMadeOfHitsForOthers) {
  const auto mesh = mesh_of(make_cube(0.5));
  Budget budget;
  EXPECT_NE(WideBvh(mesh).traverse_along_motions(budget), nullptr);
  EXPECT_EQ(PdTree(mesh).traverse_along_motions(budget), nullptr);
  Neighborhood near(mesh, std::make_shared<PdTree>(mesh), 100, budget);
  EXPECT_NE(make_motion_traversal(near), nullptr);
}

/// The wall moves to a place that was free. Cached free space must not let the tip through.
TEST(TreeTraversal, StopsOnceItsTreeIsRefit) {
  Sources sources(make_cube(5.0));
  const Motion motion{.tip = Vec3(0.0, 0.0, 58.0), .desired = Vec3(0.0, 0.0, -4.0)};
  const StepOptions options{.radius = 5.0, .margin = 1.0};
  ASSERT_EQ(sources.traversing(motion, options).status, Status::free);
  const auto mesh = mesh_of(moved(surface_of(*sources.mesh), {0.0, 0.0, 5.0}));
  sources.tree->refit(mesh);
  const Outcome stopped = sources.traversing(motion, options);
  EXPECT_EQ(stopped.status, Status::mesh_changed);
  EXPECT_EQ(stopped.motion, Vec3::Zero());

  const Outcome anew(guard(mesh, sources.tree, options)->step(motion));
  EXPECT_EQ(anew.status, Status::limited);
  EXPECT_NEAR(anew.motion.z(), -2.0, 1e-6);
}

/// Tests margins near the smallest valid margin, in units of its tolerance. If one source rejects a
/// motion at once, the proof of the other must reject it too.
TEST(SourcesAtTheLeastMargin, AgreeBitForBitOnEachTarget) {
  const auto agree_on = [](const char* shape, double times) {
    Sources sources(make_shape(shape));
    const double size = sources.mesh->bounds().size().norm();
    const double tau = 2e-10 * (sources.mesh->longest_edge() + 1e-3 * size);
    const double margin = times * tau;
    NearestTriangle nearest(*sources.mesh, *sources.tree);
    Random random(17);
    std::size_t held = 0;
    for (const double clearance : {1.0 + 2.0 / times, 1.0, 1.0 - 2.4 / times, 0.7}) {
      for (const Vec3& start :
           surface_points(*sources.mesh, test::trials(40), 20.0 * margin, random)) {
        const ClosestPoint closest = nearest(start).closest;
        Vec3 tip = start + closest.offset * (1.0 - clearance * margin / closest.distance);
        for (int cycle = 0; cycle < 8; ++cycle) {
          const double length = margin * std::pow(10.0, random.uniform(0.0, 5.0));
          const Vec3 way = (closest.offset.normalized() + random.direction()).normalized();
          const StepOptions options{.radius = 1.1 * length, .margin = 1.02 * margin};
          const Motion motion{.tip = tip, .desired = length * way};
          const Outcome expected = sources.asking(motion, options);
          EXPECT_EQ(sources.traversing(motion, options), expected)
              << shape << " " << times << " " << tip.transpose();
          held += expected.status == Status::limited || expected.status == Status::recovering;
          tip += expected.motion;
        }
      }
    }
    return held;
  };
  on_each_simd_target([&] {
    for (const double times : {9.0, 12.0, 40.0, 300.0, 1500.0}) {
      std::size_t held = 0;
      for (const char* shape : {"cortex", "gear", "star_bumps"}) held += agree_on(shape, times);
      EXPECT_GT(held, test::trials(200u)) << times;
    }
  });
}

/// Far from the origin, the second float of a tip matters, and coordinates are not floats.
TEST(SourcesFarOff, AgreeBitForBitFarFromTheOrigin) {
  Surface surface = make_shape("cortex");
  for (Vec3& v : surface.vertices) v = 1.1 * v + Vec3(1234.5678, -987.654321, 3456.789);
  Sources sources(std::move(surface));
  ASSERT_FALSE(sources.tree->tree().frame().is_exact());
  std::size_t limited = 0;
  drag(sources, scales[0], 10, [&](const Motion& motion, double margin, double length) {
    const StepOptions options{.radius = 1.1 * length, .margin = margin};
    const Outcome expected = sources.asking(motion, options);
    EXPECT_EQ(sources.traversing(motion, options), expected);
    limited += expected.status == Status::limited;
    return expected.motion;
  });
  EXPECT_GT(limited, 50u);
}

/// The tip is almost on the surface, so all triangles of the mesh are too close. Together with the
/// walls, which count again, they outnumber the triangles of the mesh.
TEST(SourcesOfFewTriangles, AgreeBitForBitWhereAllOfThemAreTooNear) {
  Sources sources(make_shape("fan"));
  const StepOptions options{.radius = 0.77441466440074269,
                            .margin = 3.2828089091695691,
                            .recovery = 3.815327964143576,
                            .refinements = 2};
  const Motion motion{.tip = {0.94064291854926918, -1.9268900355953931, 19.103223995590586},
                      .desired = {0.34218607883870539, 0, 0}};
  const Outcome expected = sources.asking(motion, options);
  EXPECT_EQ(expected.status, Status::recovering);
  EXPECT_EQ(sources.traversing(motion, options), expected);
}

}  // namespace
}  // namespace keepout
