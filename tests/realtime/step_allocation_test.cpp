// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/solvers/registry.h"
#include "realtime/counted_allocations.h"

namespace keepout {
namespace {

TEST(Allocations, AreCounted) {
  const std::size_t before = allocations();
  const auto made = std::make_unique<std::vector<double>>(10);
  EXPECT_EQ(allocations(), before + 2);
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(5, static_cast<int>(made->size()));
  EXPECT_EQ(allocations(), before + 3) << matrix.sum();
}

TEST(Step, AllocatesNothingWhateverItsPartsAndItsOutcome) {
  const auto mesh = std::make_shared<const Mesh>(make_shape("cortex"));
  Random random(1);
  const std::vector<Vec3> tips = surface_points(*mesh, 200, 0.5, random);
  Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian(3, 7);
  for (int i = 0; i < jacobian.size(); ++i) jacobian.data()[i] = random.normal();

  for (const IndexBackend& index : index_backends()) {
    for (const ActivationEntry& rule : activation_rules()) {
      for (const SolverBackend& solver : solver_backends()) {
        SCOPED_TRACE(std::string(index.name) + " " + std::string(rule.name) + " " +
                     std::string(solver.name));
        MotionConstraint constraint =
            make_motion_constraint(mesh, {.index = std::string(index.name),
                                          .activation = std::string(rule.name),
                                          .solver = std::string(solver.name),
                                          .radius = 4.0,
                                          .margin = 0.1,
                                          .damping = 1e-6});
        std::vector<std::size_t> outcomes(16, 0);
        const std::size_t before = allocations();
        for (const Vec3& tip : tips) {
          StageTimes times;
          const Vec3 desired = random.direction() * 2.0;
          ++outcomes[static_cast<std::size_t>(
              constraint.step({.tip = tip, .desired = desired}, times).status)];
          constraint.step({.tip = tip, .desired = desired, .jacobian = jacobian});
          constraint.step({.tip = tip, .desired = 10.0 * desired});
        }
        EXPECT_EQ(allocations(), before);
        EXPECT_GT(outcomes[static_cast<std::size_t>(Status::limited)], 0u);
      }
    }
  }
}

}  // namespace
}  // namespace keepout
