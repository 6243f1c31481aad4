// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <memory>
#include <set>
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
  const auto plates = std::make_shared<const Mesh>(make_shape("thin_plates"));
  const Vec3 in_the_gap(0, 0, plates->bounds().low.z() + 1.5);
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
        MotionConstraint small = make_motion_constraint(mesh, {.index = std::string(index.name),
                                                               .activation = std::string(rule.name),
                                                               .solver = std::string(solver.name),
                                                               .radius = 4.0,
                                                               .capacity = {.triangles = 1}});
        // Between two plates, closer to both than the margin allows.
        MotionConstraint wide =
            make_motion_constraint(plates, {.index = std::string(index.name),
                                            .activation = std::string(rule.name),
                                            .solver = std::string(solver.name),
                                            .radius = 2.0,
                                            .margin = 0.75});
        std::set<Status> outcomes;
        std::vector<Status> seen;
        seen.reserve(10 * tips.size());
        const std::size_t before = allocations();
        for (const Vec3& tip : tips) {
          StageTimes times;
          const Vec3 desired = random.direction() * 2.0;
          seen.push_back(constraint.step({.tip = tip, .desired = desired}, times).status);
          seen.push_back(constraint.step({.tip = tip, .desired = -10.0 * desired}).status);
          seen.push_back(constraint.step({.tip = tip}).status);
          seen.push_back(
              constraint.step({.tip = tip, .desired = desired, .jacobian = jacobian}).status);
          seen.push_back(small.step({.tip = tip, .desired = desired, .jacobian = jacobian}).status);
          seen.push_back(wide.step({.tip = in_the_gap, .desired = 0.1 * desired}).status);
          seen.push_back(
              wide.step({.tip = 2.0 * tip, .desired = 0.1 * desired, .jacobian = jacobian}).status);
        }
        EXPECT_EQ(allocations(), before);
        outcomes.insert(seen.begin(), seen.end());
        for (const Status status :
             {Status::free, Status::limited, Status::infeasible, Status::ill_posed,
              Status::invalid_input, Status::beyond_reach, Status::over_capacity}) {
          EXPECT_TRUE(outcomes.contains(status)) << name(status);
        }
      }
    }
  }
}

}  // namespace
}  // namespace keepout
