// SPDX-License-Identifier: BSD-3-Clause
// Records what the rule of Li et al. (2020) does where some reading of it fails, for comparison
// with other rules.

#include <map>

#include "accuracy/segment_crossing.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/counterexamples.h"
#include "meshes.h"
#include "trials.h"

namespace keepout {
namespace {

struct Record {
  std::size_t planes;
  bool passes_through;
  Vec3 motion;
};

const std::map<std::string_view, Record> records{
    // Safe, because coplanar edges count as convex.
    {"CE1_coplanar_tie", {1, false, {0, 0, -0.1}}},
    // A boundary edge has no neighbor, so no condition holds.
    {"CE2_boundary", {0, true, {0, 0.05, -0.15}}},
    // Safe with the corrected sign of the convexity.
    {"CE3_obtuse_valley", {2, false, {-0.625, 0, 0.325}}},
    // Both faces of the ridge add a plane: safe, but motions along either face are lost as well.
    {"CE4_on_a_ridge", {2, false, {0, 0, 0}}},
    // The nearest point of the blocking triangle is on a ridge. A nearer neighbor replaces the
    // triangle, but the neighbor's plane does not cover it.
    {"CE5_closed_octahedron", {2, true, {0.6411158, 1.7530604, 0.8382149}}},
    {"CE6b_saddle", {1, true, {0.641005, 1.750159, 0.837938}}},
    // The desired motion was free; the plane deflects it into the mesh.
    {"CE6c_larger_saddle", {1, true, {3.7044157, 7.4638551, 2.7698837}}},
    // The desired motion was free; a thousandth of it remains.
    {"CE7_lock_up", {3, false, {0.0001, 0.0008, 0.0005}}},
    // Safe, because Condition 3 is checked at vertices too.
    {"CE8_vertex_branch", {4, false, {2.605882, 0.929412, -0.929412}}},
};

class PaperCounterexample : public testing::TestWithParam<Counterexample> {};

TEST_P(PaperCounterexample, DoesWhatIsOnRecord) {
  const Counterexample& example = GetParam();
  const Record& record = records.at(example.name);
  const auto mesh = mesh_of(example.surface);
  MotionConstraint constraint = make_motion_constraint(
      mesh, {.activation = "paper", .options = {.radius = example.radius, .margin = 0.0}});
  const Step step = constraint.step({.tip = example.tip, .desired = example.desired});
  ASSERT_TRUE(step.ok()) << step.reason();
  EXPECT_EQ(step.planes.size(), record.planes);
  EXPECT_LT((step.motion - record.motion).norm(), 2e-6) << step.motion.transpose();
  EXPECT_EQ(passes_through(*mesh, example.tip, example.tip + step.motion), record.passes_through);
}

INSTANTIATE_TEST_SUITE_P(CE, PaperCounterexample, testing::ValuesIn(counterexamples()), by_name);

TEST(Counterexamples, TheMotionsThatAreSaidToBeFreeAre) {
  for (const Counterexample& example : counterexamples()) {
    const Mesh mesh(example.surface);
    const bool free = example.name == "CE6c_larger_saddle" || example.name == "CE7_lock_up";
    const bool on_the_mesh = example.name == "CE4_on_a_ridge";
    if (on_the_mesh) continue;
    EXPECT_EQ(passes_through(mesh, example.tip, example.tip + example.desired), !free)
        << example.name;
  }
}

}  // namespace
}  // namespace keepout
