// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// What is wrong is not timed, by whatever part, and however rarely.
#include "bench/measure.h"

#include <gtest/gtest.h>

#include "keepout/activation/registry.h"
#include "keepout/fixtures/motions.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/index/pd_tree.h"
#include "keepout/solvers/active_set.h"

namespace keepout::app {
namespace {

/// Does not know of one triangle.
class Forgetful final : public SpatialIndex {
 public:
  Forgetful(std::shared_ptr<const Mesh> mesh, TriangleId forgotten)
      : tree_(std::move(mesh)), forgotten_(forgotten) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    tree_.collect(ball, candidates);
    std::replace(candidates.begin(), candidates.end(), forgotten_, TriangleId{0});
  }
  std::size_t memory() const noexcept override { return tree_.memory(); }

 private:
  PdTree tree_;
  TriangleId forgotten_;
};

/// An exact solver that is made to err, or to give up, now and then.
class Flawed final : public Solver {
 public:
  enum class Flaw { shorter, gives_up, none };
  explicit Flawed(Flaw flaw) : flaw_(flaw) {}

  void reserve(int variables, int rows) override { exact_.reserve(variables, rows); }
  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override {
    const SolveStatus status = exact_.solve(problem, solution);
    if (status != SolveStatus::optimal || ++solves_ % 50 != 0) return status;
    if (flaw_ == Flaw::gives_up) return SolveStatus::iteration_limit;
    if (flaw_ == Flaw::none) return status;
    u_ = 0.9 * Vec3(solution.u[0], solution.u[1], solution.u[2]);
    solution.u = {u_.data(), 3};
    return status;
  }

 private:
  ActiveSet exact_;
  Flaw flaw_;
  int solves_ = 0;
  Vec3 u_;
};

class Measure : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    Random random(1);
    motions = contact_motions(*mesh, tree, 500, {}, random);
    rule = make_activation(GetParam(), mesh);
    rule->reserve(work.candidates.capacity());
    reference = std::make_unique<Reference>(mesh, tree, *rule, work, setting, motions);
  }

  BenchmarkRow measured(const SpatialIndex& index, Solver& solver, double accuracy) {
    solver.reserve(3, static_cast<int>(work.planes.capacity()));
    BenchmarkRow row;
    measure({*mesh, index, *rule, solver, work, setting}, motions, *reference, accuracy, 10.0, row);
    return row;
  }

  std::shared_ptr<const Mesh> mesh = std::make_shared<const Mesh>(make_shape("cortex"));
  PdTree tree{mesh};
  Workspace work{Capacity{}};
  RuleSetting setting{GetParam(), 1.0, 0.2};
  std::vector<Motion> motions;
  std::unique_ptr<Activation> rule;
  std::unique_ptr<Reference> reference;
  ActiveSet exact;
};

TEST_P(Measure, TimesWhatIsRight) {
  const BenchmarkRow row = measured(tree, exact, 0.0);
  EXPECT_TRUE(row.verified);
  EXPECT_EQ(row.remark, "");
  EXPECT_EQ(row.queries, motions.size());
  ASSERT_TRUE(row.collect && row.query && row.activate && row.solve && row.step);
  EXPECT_EQ(row.step->samples, motions.size());
  EXPECT_GE(row.step->p50, row.query->p50);
  EXPECT_GE(row.step->max, *row.step->p99);
  EXPECT_GE(row.candidates_mean, row.hits_mean);
  EXPECT_GT(row.hits_mean, 0.0);
  EXPECT_GT(row.planes_mean, 0.0);
  EXPECT_GT(row.iterations_mean, 0.0);
  EXPECT_NE(row.hash, 0u);
}

TEST_P(Measure, DoesNotTimeAnIndexThatForgetsATriangle) {
  // One that is in reach of a motion that brute force is asked about.
  const std::size_t asked = 2 * motions.size() / 8;
  TriangleBuffer candidates(mesh->triangle_count());
  HitBuffer hits(mesh->triangle_count());
  tree.collect(reference->balls()[asked], candidates);
  refine(*mesh, reference->balls()[asked], candidates.view(), hits);
  ASSERT_FALSE(hits.empty());
  const Forgetful index(mesh, hits[0].triangle);
  const BenchmarkRow row = measured(index, exact, 0.0);
  EXPECT_FALSE(row.verified);
  EXPECT_FALSE(row.step || row.collect);
  EXPECT_NE(row.remark.find("not timed"), std::string::npos);
}

TEST_P(Measure, DoesNotTimeASolverThatErrsNowAndThen) {
  Flawed solver(Flawed::Flaw::shorter);
  const BenchmarkRow row = measured(tree, solver, 1e-6);
  EXPECT_GT(row.worse_share, 0.005);
  // Under a rule that proves each motion they are right all the same.
  EXPECT_EQ(row.verified, setting.proves_motions());
  if (row.verified) return;
  EXPECT_FALSE(row.step);
  EXPECT_NE(row.remark.find("not those of the reference"), std::string::npos) << row.remark;
}

TEST_P(Measure, CountsWhatASolverLeavesUnanswered) {
  Flawed solver(Flawed::Flaw::gives_up);
  const BenchmarkRow row = measured(tree, solver, 1e-6);
  EXPECT_TRUE(row.verified);
  EXPECT_TRUE(row.step);
  EXPECT_GT(row.unsolved_share, 0.005);
  EXPECT_LT(row.unsolved_share, 0.2);
}

TEST_P(Measure, TakesAnyBitForADifferenceWhereNoneIsAllowed) {
  Flawed solver(Flawed::Flaw::gives_up);
  EXPECT_FALSE(measured(tree, solver, 0.0).verified);
}

TEST_P(Measure, GivesTheSameHashForTheSameStepsOnly) {
  Flawed same(Flawed::Flaw::none);
  const std::uint64_t hash = measured(tree, exact, 0.0).hash;
  EXPECT_EQ(measured(tree, same, 0.0).hash, hash);
  Flawed other(Flawed::Flaw::gives_up);
  EXPECT_NE(measured(tree, other, 1e-6).hash, hash);
}

INSTANTIATE_TEST_SUITE_P(Rules, Measure, testing::Values("paper", "certified"),
                         [](const auto& p) { return std::string(p.param); });

}  // namespace
}  // namespace keepout::app
