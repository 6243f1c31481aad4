// SPDX-License-Identifier: BSD-3-Clause
// Compares Step::distance with brute force: for every rule, index and SIMD target, and for both
// settings of Distances.

#include "brute_force.h"
#include "keepout/activation/registry.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/solvers/active_set.h"
#include "keepout/step/motion_constraint.h"
#include "meshes.h"

namespace keepout {
namespace {

constexpr double margin = 0.4;
constexpr double tool_radius = 0.6;
constexpr double kept = tool_radius + margin;

/// Returns the same rule on indices that offer different sources of triangles.
std::vector<MotionConstraint> forms_of(std::string_view rule,
                                       const std::shared_ptr<const Mesh>& mesh,
                                       Distances distances) {
  const std::vector<std::shared_ptr<const SpatialIndex>> indices{
      std::make_shared<WideBvh>(mesh), std::make_shared<PdTree>(mesh),
      std::make_shared<BruteForce>(mesh)};
  const StepOptions options{
      .radius = 3.0, .tool_radius = tool_radius, .margin = margin, .distances = distances};
  std::vector<MotionConstraint> forms;
  for (const auto& index : indices) {
    forms.emplace_back(mesh, index, make_activation(rule), std::make_unique<ActiveSet>(), options,
                       Capacity{}, rule == "certified" ? Inside::escape : Inside::taken_as_is);
  }
  return forms;
}

/// Returns motions in random directions, from tips near and far, on the surface and inside.
std::vector<Motion> motions_about(const Mesh& mesh) {
  Random random(11);
  std::vector<Motion> motions;
  for (const double offset : {1.6 * kept, kept, 0.5 * kept, 0.0, -0.7 * kept, 12.0 * kept}) {
    for (const Vec3& tip : surface_points(mesh, test::trials(12), offset, random)) {
      motions.push_back({.tip = tip, .desired = random.uniform(0.0, 2.0) * random.direction()});
    }
  }
  return motions;
}

class StepDistance : public ::testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<const Mesh> mesh_ = mesh_of(GetParam());
  double rounding_ = 1e-13 * (mesh_->bounds().size().norm() + mesh_->bounds().high.norm());
};

TEST_P(StepDistance, IsThatOfBruteForceWhereItIsKnownAndTheSameInEveryForm) {
  std::size_t known = 0, unknown = 0;
  auto forms = forms_of("certified", mesh_, Distances::where_known);
  for (const Motion& motion : motions_about(*mesh_)) {
    const double distance = distance_to(*mesh_, motion.tip);
    forms[0].forget();
    const Step first = forms[0].step(motion);
    for (std::size_t form = 1; form < forms.size(); ++form) {
      forms[form].forget();
      EXPECT_EQ(forms[form].step(motion).distance, first.distance) << form;
    }
    if (first.distance) {
      EXPECT_NEAR(*first.distance, distance, rounding_);
    }
    if (distance <= kept) {
      EXPECT_TRUE(first.distance) << distance << " " << name(first.status);
    }
    known += first.distance.has_value();
    unknown += !first.distance.has_value();
  }
  EXPECT_GT(known, test::trials(10u));
  EXPECT_GT(unknown, test::trials(10u));
}

TEST_P(StepDistance, OfATipThatIsPressedAgainstTheSurfaceIsKnown) {
  auto forms = forms_of("certified", mesh_, Distances::where_known);
  Random random(5);
  std::size_t held = 0, known = 0;
  for (const Vec3& start : surface_points(*mesh_, test::trials(10), 1.5 * kept, random)) {
    std::vector<Vec3> tips(forms.size(), start);
    for (auto& form : forms) form.forget();
    Vec3 into = random.direction();
    for (int cycle = 0; cycle < 20; ++cycle) {
      std::optional<double> first;
      for (std::size_t form = 0; form < forms.size(); ++form) {
        const Step step = forms[form].step({.tip = tips[form], .desired = 0.3 * into});
        if (form == 0) {
          first = step.distance;
          held += step.status == Status::limited && step.motion.norm() < 1e-6;
          known += first.has_value() && step.motion.norm() < 1e-6;
        }
        EXPECT_EQ(step.distance, first);
        tips[form] += step.motion;
      }
      if (first) {
        const double distance = distance_to(*mesh_, tips[0]);
        EXPECT_GE(distance, std::min(*first, kept) - 1e-7);
      }
    }
  }
  EXPECT_EQ(known, held) << "a tip that cannot move on is at the distance kept";
}

TEST_P(StepDistance, IsToldOfEveryTipUnderEveryRuleIfAskedFor) {
  for (const ActivationEntry& rule : activation_rules()) {
    SCOPED_TRACE(rule.name);
    auto forms = forms_of(rule.name, mesh_, Distances::always);
    for (const Motion& motion : motions_about(*mesh_)) {
      const double distance = distance_to(*mesh_, motion.tip);
      forms[0].forget();
      const Step first = forms[0].step(motion);
      ASSERT_TRUE(first.distance);
      EXPECT_NEAR(*first.distance, distance, rounding_);
      for (std::size_t form = 1; form < forms.size(); ++form) {
        forms[form].forget();
        EXPECT_EQ(forms[form].step(motion).distance, first.distance) << form;
      }
    }
  }
}

TEST_P(StepDistance, AskedForChangesNothingElse) {
  auto plain = forms_of("certified", mesh_, Distances::where_known);
  auto telling = forms_of("certified", mesh_, Distances::always);
  for (const Motion& motion : motions_about(*mesh_)) {
    plain[0].forget();
    telling[0].forget();
    const Step one = plain[0].step(motion);
    const Step other = telling[0].step(motion);
    EXPECT_EQ(one.status, other.status);
    EXPECT_EQ(one.motion, other.motion);
    EXPECT_EQ(one.planes.size(), other.planes.size());
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, StepDistance,
                         ::testing::Values("cortex", "cube", "needles", "tunnel"), by_name);

TEST(StepDistances, AreTheSameOnEveryProcessor) {
  const auto mesh = mesh_of("cortex");
  const std::vector<Motion> motions = motions_about(*mesh);
  for (const Distances distances : {Distances::where_known, Distances::always}) {
    std::vector<std::optional<double>> expected;
    for (const std::string_view target : simd_targets()) {
      SCOPED_TRACE(target);
      use_simd_target(target);
      auto forms = forms_of("certified", mesh, distances);
      std::vector<std::optional<double>> its;
      for (const Motion& motion : motions) its.push_back(forms[0].step(motion).distance);
      if (expected.empty()) expected = its;
      EXPECT_EQ(its, expected);
    }
  }
  use_simd_target(simd_targets().front());
}

TEST(StepDistances, AreNotToldForInputThatIsInvalid) {
  const auto mesh = mesh_of("cube");
  auto forms = forms_of("certified", mesh, Distances::always);
  EXPECT_FALSE(forms[0].step({.tip = {0, 0, std::nan("")}, .desired = {0, 0, 0}}).distance);
  EXPECT_FALSE(forms[0].step({.tip = {0, 0, 1e31}, .desired = {0, 0, 0}}).distance);
  // A motion that is too long is rejected, but its tip has a distance.
  EXPECT_EQ(forms[0].step({.tip = {0, 0, 60}, .desired = {0, 0, -50}}).distance, 10.0);
}

}  // namespace
}  // namespace keepout
