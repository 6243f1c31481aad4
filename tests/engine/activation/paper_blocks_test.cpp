// SPDX-License-Identifier: BSD-3-Clause
// Compares two forms of the rule of Li et al.: on an index with blocks of triangles, and by queries
// only. The results must be bitwise identical.

#include <array>

#include "brute_force.h"
#include "index/pd_tree/tree.h"
#include "index/wide_bvh/tree.h"
#include "keepout/activation/paper.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/queries_only.h"
#include "keepout/solvers/active_set.h"
#include "keepout/step/motion_constraint.h"
#include "meshes.h"
#include "step/input.h"
#include "trials.h"

namespace keepout {
namespace {

bool operator==(const HalfSpace& one, const HalfSpace& other) {
  return one.normal == other.normal && one.offset == other.offset && one.source == other.source;
}

bool are_equal(std::span<const HalfSpace> one, std::span<const HalfSpace> other) {
  return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](const HalfSpace& a, const HalfSpace& b) { return a == b; });
}

/// The rule on one mesh in two forms: with the blocks of an index of type Tree, and by queries.
template <class Tree = WideBvh>
class PaperForms {
 public:
  explicit PaperForms(const Surface& surface, const Capacity& capacity = {})
      : mesh(mesh_of(surface)),
        tree(std::make_shared<Tree>(mesh)),
        planes(capacity.planes),
        plain_planes(capacity.planes),
        near_(mesh, tree, capacity.triangles, budget_),
        plain_near_(mesh, std::make_shared<QueriesOnly>(tree), capacity.triangles, budget_),
        guard_(constraint(tree, capacity)),
        plain_guard_(constraint(std::make_shared<QueriesOnly>(tree), capacity)) {
    rule_.prepare(near_);
    plain_.prepare(plain_near_);
  }

  /// Starts a cycle with blocks and without. Returns both statuses, and fills the planes of both.
  std::array<Status, 2> start(const Vec3& tip, double radius, double margin) {
    const RuleInput input =
        rule_input_of({.tip = tip, .desired = Vec3::Zero()}, {.radius = radius, .margin = margin},
                      EndRegion::motion_sphere);
    return {start(rule_, input, planes), start(plain_, input, plain_planes)};
  }

  Step step(const Motion& motion, const StepOptions& options) {
    guard_.set_options(options);
    return guard_.step(motion);
  }
  Step plain_step(const Motion& motion, const StepOptions& options) {
    plain_guard_.set_options(options);
    return plain_guard_.step(motion);
  }
  bool makes_queries() const { return guard_.makes_queries(); }
  bool plain_makes_queries() const { return plain_guard_.makes_queries(); }
  std::size_t triangles() const { return rule_.triangles(); }
  std::size_t plain_triangles() const { return plain_.triangles(); }

  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<Tree> tree;
  HalfSpaceBuffer planes;
  HalfSpaceBuffer plain_planes;

 private:
  static Status start(PaperRule& rule, const RuleInput& input, HalfSpaceBuffer& planes) {
    planes.clear();
    return rule.gather(input) ? rule.open(input, planes).status : Status::over_capacity;
  }

  MotionConstraint constraint(std::shared_ptr<const SpatialIndex> index, const Capacity& capacity) {
    return {mesh,
            std::move(index),
            std::make_unique<PaperRule>(),
            std::make_unique<ActiveSet>(),
            {.radius = 1e-3 * mesh->bounds().size().norm(), .margin = 0.0},
            capacity};
  }

  Budget budget_;
  Neighborhood near_;
  Neighborhood plain_near_;
  PaperRule rule_;
  PaperRule plain_;
  MotionConstraint guard_;
  MotionConstraint plain_guard_;
};

/// Returns tips above, on and below faces, edges and corners, and farther away.
std::vector<Vec3> tips_around(const Mesh& mesh, std::size_t count) {
  const double size = mesh.bounds().size().norm();
  Random random(3);
  std::vector<Vec3> tips = vertex_points(mesh, count, random);
  const auto add = [&](const std::vector<Vec3>& more) {
    tips.insert(tips.end(), more.begin(), more.end());
  };
  add(edge_points(mesh, count, random));
  for (const double offset : {0.0, 1e-12, 1e-6, 2e-3, 0.03, -1e-4, -0.02}) {
    add(surface_points(mesh, count, offset * size, random));
  }
  add(random_points(mesh, count, random));
  // If a tip is right above a corner or an edge, neighbors share their closest point.
  for (std::size_t i = 0; i < 2 * count; ++i) tips.push_back(tips[i] + Vec3(0, 0, 1e-3 * size));
  return tips;
}

template <class Forms>
void expect_same_planes(Forms& forms, std::size_t tips, std::size_t& planes) {
  const double size = forms.mesh->bounds().size().norm();
  for (const Vec3& tip : tips_around(*forms.mesh, tips)) {
    for (const double radius : {1e-3 * size, 0.02 * size, 0.1 * size}) {
      for (const double margin : {0.0, 4e-3 * size}) {
        const auto [got, expected] = forms.start(tip, radius, margin);
        ASSERT_EQ(got, expected);
        ASSERT_EQ(forms.triangles(), forms.plain_triangles());
        ASSERT_TRUE(are_equal(forms.planes.view(), forms.plain_planes.view()))
            << tip.transpose() << " radius " << radius << " margin " << margin;
        planes += forms.plain_planes.size();
      }
    }
  }
}

class PaperBlocksOn : public testing::TestWithParam<std::string> {};

TEST_P(PaperBlocksOn, ThePlanesAreThoseOfThePlainRuleOnEachTarget) {
  std::size_t on_the_first = 0;
  on_each_simd_target([&] {
    PaperForms forms(make_shape(GetParam()));
    std::size_t planes = 0;
    expect_same_planes(forms, 6, planes);
    EXPECT_GT(planes, GetParam() == "needles" ? 0u : 100u);
    if (on_the_first == 0) on_the_first = planes;
    EXPECT_EQ(planes, on_the_first);
  });
}

/// Returns motions toward the surface, along it and away from it, up to the radius.
std::vector<Motion> motions_around(const Mesh& mesh, double radius) {
  Random random(5);
  std::vector<Motion> motions;
  for (const Vec3& tip : tips_around(mesh, 4)) {
    for (const double length : {0.02, 0.3, 1.0}) {
      motions.push_back({.tip = tip, .desired = length * radius * random.direction()});
    }
  }
  motions.push_back({.tip = motions.front().tip, .desired = Vec3::Zero()});
  return motions;
}

void expect_same_step(const Step& got, const Step& expected) {
  ASSERT_EQ(got.status, expected.status);
  ASSERT_EQ(got.motion, expected.motion);
  ASSERT_EQ(got.triangles, expected.triangles);
  ASSERT_EQ(got.active.size(), expected.active.size());
  for (std::size_t i = 0; i < got.active.size(); ++i) {
    ASSERT_TRUE(got.planes[got.active[i]] == expected.planes[expected.active[i]]);
  }
  // Omitted planes do not change the order of the others.
  ASSERT_TRUE(std::includes(
      expected.planes.begin(), expected.planes.end(), got.planes.begin(), got.planes.end(),
      [](const HalfSpace& a, const HalfSpace& b) { return a.source < b.source; }));
}

TEST_P(PaperBlocksOn, TheStepsAreThoseOfThePlainRuleAndAlikeOnEachTarget) {
  PaperForms forms(make_shape(GetParam()));
  const double size = forms.mesh->bounds().size().norm();
  std::vector<std::pair<Status, Vec3>> on_the_first;
  on_each_simd_target([&] {
    std::vector<std::pair<Status, Vec3>> made;
    for (const double radius : {2e-3 * size, 0.05 * size}) {
      for (const double margin : {0.0, 2e-3 * size}) {
        for (const Motion& motion : motions_around(*forms.mesh, radius)) {
          const StepOptions options{.radius = radius, .margin = margin};
          const Step expected = forms.plain_step(motion, options);
          ASSERT_NO_FATAL_FAILURE(expect_same_step(forms.step(motion, options), expected));
          made.emplace_back(expected.status, expected.motion);
        }
      }
    }
    if (on_the_first.empty()) on_the_first = made;
    EXPECT_TRUE(made == on_the_first);
  });
}

INSTANTIATE_TEST_SUITE_P(Shapes, PaperBlocksOn, testing::ValuesIn(names_of_shapes()), by_name);

TEST(PaperBlocks, ThePlanesAreThoseOfThePlainRuleWhereTheFloatsAreExact) {
  PaperForms forms(as_floats(make_gear(1.0)));
  ASSERT_TRUE(forms.tree->tree().frame().is_exact());
  std::size_t planes = 0;
  expect_same_planes(forms, 12, planes);
  EXPECT_GT(planes, 1000u);
}

TEST(PaperBlocks, ThePlanesAreThoseOfThePlainRuleFarFromTheOriginAndAtEveryScale) {
  for (const double scale : {1e-13, 1e-9, 1e9, 1e12}) {
    PaperForms forms(enlarged(make_cortex(6.0, 1), scale));
    std::size_t planes = 0;
    expect_same_planes(forms, 4, planes);
    EXPECT_GT(planes, 1000u) << scale;
  }
  PaperForms forms(moved(make_cortex(6.0, 1), {1e6, -2e6, 3e5}));
  std::size_t planes = 0;
  expect_same_planes(forms, 4, planes);
  EXPECT_GT(planes, 1000u);
}

TEST(PaperBlocks, MostPlanesOfAShortMotionAreIdleAndLeftOut) {
  PaperForms forms(make_shape("cortex"));
  Random random(1);
  std::size_t got = 0, expected = 0;
  for (const Vec3& tip : surface_points(*forms.mesh, 50, 0.2, random)) {
    const Motion motion{.tip = tip, .desired = 0.1 * random.direction()};
    got += forms.step(motion, {.radius = 10.0, .margin = 0.0}).planes.size();
    expected += forms.plain_step(motion, {.radius = 10.0, .margin = 0.0}).planes.size();
  }
  EXPECT_GT(got, 0u);
  EXPECT_LT(2 * got, expected);
}

TEST(PaperBlocks, WithJointsOrRowsAllPlanesArePosed) {
  PaperForms forms(make_shape("cortex"));
  Random random(1);
  Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian(3, 6);
  for (int i = 0; i < jacobian.size(); ++i) jacobian.data()[i] = normal(random);
  const std::array<double, 3> row{1.0, 0.0, 0.0};
  const double bound = -0.01;
  for (const Vec3& tip : surface_points(*forms.mesh, 20, 0.2, random)) {
    Motion motion{.tip = tip, .desired = 0.1 * random.direction()};
    motion.jacobian.emplace(jacobian);
    Step got = forms.step(motion, {.radius = 5.0, .margin = 0.0, .damping = 1e-6});
    EXPECT_TRUE(are_equal(
        got.planes,
        forms.plain_step(motion, {.radius = 5.0, .margin = 0.0, .damping = 1e-6}).planes));
    EXPECT_FALSE(got.planes.empty());
    motion.jacobian.reset();
    motion.rows.emplace(row.data(), &bound, 1);
    got = forms.step(motion, {.radius = 5.0, .margin = 0.0});
    const Step expected = forms.plain_step(motion, {.radius = 5.0, .margin = 0.0});
    EXPECT_TRUE(are_equal(got.planes, expected.planes));
    EXPECT_EQ(got.motion, expected.motion);
  }
}

TEST(PaperBlocks, ATriangleCountsJustWithinTheBallAndNotJustBeyond) {
  PaperForms forms(make_shape("cortex"));
  Random random(2);
  std::size_t reached = 0;
  on_each_simd_target([&] {
    for (const Vec3& tip : surface_points(*forms.mesh, 30, 0.4, random)) {
      const double distance = distance_to(*forms.mesh, tip);
      for (const double relative : {-1e-6, -1e-7, -1e-8, 1e-8, 1e-7, 1e-6}) {
        const auto [got, expected] = forms.start(tip, distance * (1.0 + relative), 0.0);
        ASSERT_EQ(got, expected);
        ASSERT_EQ(forms.triangles(), forms.plain_triangles()) << relative;
        ASSERT_EQ(forms.triangles() > 0, relative > 0.0) << relative;
        reached += forms.triangles();
      }
    }
  });
  EXPECT_GT(reached, 300u);
}

TEST(PaperBlocks, WhatIsBeyondTheCapacityEndsAsWithThePlainRule) {
  const Surface surface = make_shape("cortex");
  Random random(1);
  const std::vector<Vec3> tips = surface_points(Mesh(surface), 30, 0.2, random);
  std::size_t over = 0;
  for (const Capacity& capacity : {Capacity{.triangles = 40}, Capacity{.planes = 10}}) {
    PaperForms forms(surface, capacity);
    for (const Vec3& tip : tips) {
      for (const double radius : {1.0, 3.0, 9.0}) {
        const Motion motion{.tip = tip, .desired = Vec3(0.05, 0, 0)};
        const Step got = forms.step(motion, {.radius = radius, .margin = 0.0});
        const Step expected = forms.plain_step(motion, {.radius = radius, .margin = 0.0});
        ASSERT_EQ(got.status, expected.status);
        ASSERT_EQ(got.motion, expected.motion);
        ASSERT_EQ(got.triangles, expected.triangles);
        if (got.status == Status::over_capacity) ++over;
      }
    }
  }
  EXPECT_GT(over, 30u);
}

TEST(PaperBlocks, OnlyForAnIndexThatHasBlocks) {
  const PaperForms forms(make_cube(20.0));
  EXPECT_FALSE(forms.makes_queries());
  EXPECT_TRUE(forms.plain_makes_queries());
}

TEST(PaperBlocks, ThePlanesAreThoseOfThePlainRuleWhateverTheIndexThatHasTheBlocks) {
  for (const char* shape : {"cortex", "gear", "needles"}) {
    SCOPED_TRACE(shape);
    PaperForms<PdTree> forms(make_shape(shape));
    std::size_t planes = 0;
    expect_same_planes(forms, 6, planes);
    EXPECT_GT(planes, std::string(shape) == "needles" ? 0u : 100u);
  }
}

TEST(PaperBlocks, StopsOnceItsTreeIsRefit) {
  PaperForms forms(make_cube(5.0));
  const Motion motion{.tip = Vec3(0.0, 0.0, 58.0), .desired = Vec3(0.0, 0.0, -4.0)};
  ASSERT_EQ(forms.step(motion, {.radius = 5.0, .margin = 0.0}).status, Status::free);
  forms.tree->refit(mesh_of(moved(surface_of(*forms.mesh), {0.0, 0.0, 5.0})));
  const Step stopped = forms.step(motion, {.radius = 5.0, .margin = 0.0});
  EXPECT_EQ(stopped.status, Status::mesh_changed);
  EXPECT_EQ(stopped.motion, Vec3::Zero());
}

}  // namespace
}  // namespace keepout
