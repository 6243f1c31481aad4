// SPDX-License-Identifier: BSD-3-Clause
// A step with a solver of a library agrees with a step with active_set, or has no motion and a
// status.

#include "accuracy/certified_loop.h"
#include "keepout/solvers/registry.h"

namespace keepout::test {
namespace {

constexpr double margin = 0.25;

struct Counts {
  std::size_t steps = 0, held_back = 0, not_ok = 0, different = 0;
};

class LibrarySolverStep : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const auto entries = solver_backends();
    const bool here = std::ranges::any_of(
        entries, [](const SolverBackend& backend) { return backend.name == "nlopt_slsqp"; });
    if (!here) GTEST_SKIP() << "this build was made without nlopt_slsqp";
  }

  /// Runs closed loops in contact with active_set. The other solver computes each step as well.
  Counts run(const Shape& shape, bool joints) {
    const auto mesh = mesh_of(shape.make());
    MotionConstraintSettings settings{
        .activation = GetParam(),
        .options = {.radius = 2.0, .margin = margin, .damping = joints ? 1e-6 : 0.0}};
    MotionConstraint exact = make_motion_constraint(mesh, settings);
    settings.solver = "nlopt_slsqp";
    MotionConstraint other = make_motion_constraint(mesh, settings);
    Random random(11);
    Counts counts;
    for (const Vec3& start : surface_points(*mesh, 8, 1.5 * margin, random)) {
      TipJacobian::Matrix jacobian(3, 7);
      for (int c = 0; c < 7; ++c) jacobian.col(c) = random.uniform(0.5, 2.0) * random.direction();
      const Vec3 press = random.direction();
      Vec3 tip = start;
      for (int cycle = 0; cycle < 25; ++cycle) {
        Motion motion{.tip = tip,
                      .desired = random.uniform(0.1, 0.5) * (press + random.direction())};
        if (joints) motion.jacobian = jacobian;
        const Step expected = exact.step(motion);
        const Step got = other.step(motion);
        ++counts.steps;
        if (expected.status == Status::limited) ++counts.held_back;
        if (!got.ok()) {
          EXPECT_EQ(got.motion, Vec3::Zero());
          EXPECT_TRUE(got.increment.empty());
          if (expected.ok()) ++counts.not_ok;
        } else if (!expected.ok() ||
                   (got.motion - expected.motion).norm() > 1e-6 * motion.desired.norm()) {
          ++counts.different;
        }
        tip += expected.motion;
      }
    }
    return counts;
  }
};

TEST_P(LibrarySolverStep, AgreesWithOurOwnOrStandsStill) {
  for (const bool joints : {false, true}) {
    Counts all;
    for (const Shape& shape : shapes()) {
      const Counts counts = run(shape, joints);
      EXPECT_EQ(counts.different, 0u) << shape.name << ", joints: " << joints;
      all.steps += counts.steps;
      all.held_back += counts.held_back;
      all.not_ok += counts.not_ok;
    }
    EXPECT_LE(all.not_ok, all.steps / 200) << "of " << all.steps << ", joints: " << joints;
    EXPECT_GT(all.held_back, all.steps / 10) << "of " << all.steps << ", joints: " << joints;
  }
}

INSTANTIATE_TEST_SUITE_P(Rules, LibrarySolverStep,
                         testing::Values("all_faces", "paper", "certified"), by_name);

}  // namespace
}  // namespace keepout::test
