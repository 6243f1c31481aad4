// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// The certified rule on a tree of its own, held to the plain rule bit for bit.
#include "activation/certified_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "each_simd_target.h"
#include "keepout/activation/certified.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/random.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/index/nearest.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/solvers/active_set.h"
#include "keepout/step/step.h"
#include "names_of_shapes.h"

namespace keepout {
namespace {

/// All that a step comes to.
struct Outcome {
  Status status;
  Vec3 motion;
  std::vector<double> increment;
  std::vector<HalfSpace> planes;
  std::optional<double> distance;

  explicit Outcome(const Step& step)
      : status(step.status),
        motion(step.motion),
        increment(step.increment.begin(), step.increment.end()),
        planes(step.planes.begin(), step.planes.end()),
        distance(step.distance) {}

  /// The sources of planes count too, but for triangles that are one on top of the other.
  friend bool operator==(const Outcome& a, const Outcome& b) {
    return a.status == b.status && a.motion == b.motion && a.increment == b.increment &&
           a.distance == b.distance &&
           std::equal(a.planes.begin(), a.planes.end(), b.planes.begin(), b.planes.end(),
                      [](const HalfSpace& p, const HalfSpace& q) {
                        return p.normal == q.normal && p.offset == q.offset;
                      });
  }
};

/// Both forms of the rule on one mesh, each with an index of its own.
class CertifiedForms {
 public:
  explicit CertifiedForms(Surface surface)
      : mesh(std::make_shared<const Mesh>(std::move(surface))),
        tree(mesh),
        other_tree(mesh),
        plain(mesh),
        searching(plain.searching(tree)),
        work({.nodes = 16}),
        plain_work({.nodes = 16}) {
    plain.reserve(plain_work.candidates.capacity());
    solver.reserve(7, static_cast<int>(work.planes.capacity()) + 8);
  }

  Outcome step(const Motion& motion, const StepOptions& options) {
    return Outcome(keepout::step(*mesh, tree, *searching, solver, motion, options, work));
  }
  Outcome plain_step(const Motion& motion, const StepOptions& options) {
    return Outcome(keepout::step(*mesh, other_tree, plain, solver, motion, options, plain_work));
  }

  std::shared_ptr<const Mesh> mesh;
  WideBvh tree;
  PdTree other_tree;
  CertifiedRule plain;
  std::unique_ptr<Activation> searching;
  ActiveSet solver;
  Workspace work;
  Workspace plain_work;
};

/// Lengths as shares of the mesh's size.
struct Scale {
  double margin;
  double motion;
};
constexpr Scale scales[] = {{0.005, 0.003}, {0.001, 0.02}, {0.03, 0.002}, {0.02, 0.1}};

/// What a hand does that presses and drags, from tips that keep the margin, are too close, touch,
/// or are inside; the tip goes where the plain rule lets it.
template <class Ask>
void drag(CertifiedForms& forms, const Scale& scale, std::size_t strokes, Ask&& ask) {
  const double size = forms.mesh->bounds().size().norm();
  const double margin = scale.margin * size;
  const double motion = scale.motion * size;
  const PdTree nearby(forms.mesh);
  NearestTriangle nearest(*forms.mesh, nearby);
  Random random(7);
  for (const double offset : {1.5 * margin, 0.3 * margin, 0.0, -0.5 * margin}) {
    for (const Vec3& start : surface_points(*forms.mesh, strokes, offset, random)) {
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

class CertifiedSearchOn : public ::testing::TestWithParam<std::string> {};

TEST_P(CertifiedSearchOn, StepsAsThePlainRuleDoesAndAlikeOnEachTarget) {
  CertifiedForms forms(make_shape(GetParam()));
  ASSERT_NE(forms.searching, nullptr);
  ASSERT_TRUE(forms.searching->searches());
  std::vector<Outcome> on_the_first;
  on_each_simd_target([&] {
    std::vector<Outcome> made;
    for (const Scale& scale : scales) {
      drag(forms, scale, 4, [&](const Motion& motion, double margin, double length) {
        const StepOptions options{
            .radius = 1.1 * length, .margin = margin, .recovery = 0.2 * margin};
        made.push_back(forms.plain_step(motion, options));
        EXPECT_EQ(forms.step(motion, options), made.back())
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

INSTANTIATE_TEST_SUITE_P(Shapes, CertifiedSearchOn, ::testing::ValuesIn(names_of_shapes()),
                         [](const auto& shape) { return shape.param; });

TEST(CertifiedSearchOptions, StepsAsThePlainRuleDoesWithOptionsJointsAndRowsOnEachTarget) {
  CertifiedForms forms(make_shape("cortex"));
  const TipJacobian::Matrix jacobian = [] {
    TipJacobian::Matrix j(3, 5);
    j << 1, 0, 0, 0.5, -0.3, 0, 1, 0, 0.2, 0.7, 0, 0, 1, -0.4, 0.1;
    return j;
  }();
  const std::vector<double> matrix{1, 0, 0, -1, 0, 0}, bounds{-0.001, -0.5};
  std::size_t limited = 0;
  const auto ask_on = [&](const Scale& scale) {
    drag(forms, scale, 6, [&](const Motion& motion, double margin, double length) {
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
        const Outcome expected = forms.plain_step(asked, options);
        EXPECT_EQ(forms.step(asked, options), expected) << "variant " << variant;
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

TEST(CertifiedSearchMemory, DoesNotChangeAnswers) {
  CertifiedForms forms(make_shape("star_bumps"));
  std::size_t limited = 0;
  drag(forms, scales[0], 10, [&](const Motion& motion, double margin, double length) {
    const StepOptions options{.radius = 1.1 * length, .margin = margin};
    const Outcome remembered = forms.step(motion, options);
    const auto fresh = forms.plain.searching(forms.tree);
    EXPECT_EQ(Outcome(step(*forms.mesh, forms.tree, *fresh, forms.solver, motion, options,
                           forms.plain_work)),
              remembered);
    limited += remembered.status == Status::limited;
    return remembered.motion;
  });
  EXPECT_GT(limited, 50u);
}

/// A reach that grew with every stroke until large boxes were left over would have each cycle look
/// into them, and would cover all that is asked about, so that nothing would ever mend it.
TEST(CertifiedSearchMemory, IsOfLeavesHoweverManyStrokesThereWere) {
  const auto mesh = std::make_shared<const Mesh>(make_shape("cortex"));
  const WideBvh tree(mesh);
  const PdTree nearby(mesh);
  NearestTriangle nearest(*mesh, nearby);
  CertifiedSearch rule(mesh, tree);
  ActiveSet solver;
  Workspace work({.triangles = 1});
  solver.reserve(3, static_cast<int>(work.planes.capacity()));
  const double size = mesh->bounds().size().norm();
  const StepOptions options{.radius = 2e-3 * size, .margin = 2e-3 * size};
  Random random(3);
  int limited = 0, unopened = 0;
  for (Vec3 tip : surface_points(*mesh, 300, 1.2 * options.margin, random)) {
    const Vec3 along = random.direction();
    for (int cycle = 0; cycle < 20; ++cycle) {
      const Vec3 way = nearest(tip).closest.offset.normalized() + along;
      const Motion motion{.tip = tip, .desired = 0.5 * options.radius * way.normalized()};
      const Step made = step(*mesh, tree, rule, solver, motion, options, work);
      limited += made.status == Status::limited;
      unopened += rule.frontier().is_opened() ? 0 : 1;
      tip += made.motion;
    }
  }
  EXPECT_GT(limited, 3000);
  EXPECT_LT(unopened, 60);  // one in a hundred, at the end of a reach that was tried
}

TEST(CertifiedSearchIndex, IsForWideBvhOnly) {
  const auto mesh = std::make_shared<const Mesh>(make_cube(0.5));
  EXPECT_EQ(CertifiedRule(mesh).searching(PdTree(mesh)), nullptr);
}

/// The wall comes to where it was free: what was known of free space must not let the tip through.
TEST(CertifiedSearchIndex, StopsOnceItsTreeIsRefit) {
  CertifiedForms forms(make_cube(5.0));
  const Motion motion{.tip = Vec3(0.0, 0.0, 58.0), .desired = Vec3(0.0, 0.0, -4.0)};
  const StepOptions options{.radius = 5.0, .margin = 1.0};
  ASSERT_EQ(forms.step(motion, options).status, Status::free);
  Surface raised{{forms.mesh->vertices().begin(), forms.mesh->vertices().end()},
                 {forms.mesh->triangles().begin(), forms.mesh->triangles().end()}};
  for (Vec3& v : raised.vertices) v.z() += 5.0;
  const auto mesh = std::make_shared<const Mesh>(std::move(raised));
  forms.tree.refit(mesh);
  const Outcome stopped = forms.step(motion, options);
  EXPECT_EQ(stopped.status, Status::over_capacity);
  EXPECT_EQ(stopped.motion, Vec3::Zero());

  const auto anew = CertifiedRule(mesh).searching(forms.tree);
  const Step step =
      keepout::step(*mesh, forms.tree, *anew, forms.solver, motion, options, forms.work);
  EXPECT_EQ(step.status, Status::limited);
  EXPECT_NEAR(step.motion.z(), -2.0, 1e-6);
}

/// Far from the origin, where a tip's second float matters, and coordinates are no floats.
TEST(CertifiedSearchPrecision, StepsAsThePlainRuleDoesFarFromTheOrigin) {
  Surface surface = make_shape("cortex");
  for (Vec3& v : surface.vertices) v = 1.1 * v + Vec3(1234.5678, -987.654321, 3456.789);
  CertifiedForms forms(std::move(surface));
  ASSERT_GT(forms.tree.coordinate_error(), 0.0);
  std::size_t limited = 0;
  drag(forms, scales[0], 10, [&](const Motion& motion, double margin, double length) {
    const StepOptions options{.radius = 1.1 * length, .margin = margin};
    const Outcome expected = forms.plain_step(motion, options);
    EXPECT_EQ(forms.step(motion, options), expected);
    limited += expected.status == Status::limited;
    return expected.motion;
  });
  EXPECT_GT(limited, 50u);
}

}  // namespace
}  // namespace keepout
