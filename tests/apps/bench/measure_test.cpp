// SPDX-License-Identifier: BSD-3-Clause
// What is wrong is not timed, by whatever part, and however rarely.
#include "bench/measure.h"

#include <gtest/gtest.h>

#include <bit>

#include "by_name.h"
#include "keepout/activation/registry.h"
#include "keepout/fixtures/motions.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/solvers/active_set.h"
#include "meshes.h"
#include "messages.h"
#include "queries_only.h"

namespace keepout::app {
namespace {

/// Does not know of one triangle.
class Forgetful final : public SpatialIndex {
 public:
  Forgetful(std::shared_ptr<const Mesh> mesh, TriangleId forgotten)
      : SpatialIndex(mesh), tree_(std::move(mesh)), forgotten_(forgotten) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    tree_.collect(ball, candidates);
    std::replace(candidates.begin(), candidates.end(), forgotten_, TriangleId{0});
  }
  std::size_t memory() const noexcept override { return tree_.memory(); }

 private:
  PdTree tree_;
  TriangleId forgotten_;
};

/// An exact solver that is made to err, or to give up, now and then: always at the same problems.
class Flawed final : public Solver {
 public:
  enum class Flaw { shorter, gives_up, none };
  explicit Flawed(Flaw flaw) : flaw_(flaw) {}

  void reserve(int variables, int rows) override { exact_.reserve(variables, rows); }
  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override {
    const SolveStatus status = exact_.solve(problem, solution);
    const auto bits = std::bit_cast<std::uint64_t>(problem.desired[0]);
    if (status != SolveStatus::optimal || bits % 50 != 0) return status;
    if (flaw_ == Flaw::gives_up) return SolveStatus::iteration_limit;
    if (flaw_ == Flaw::none) return status;
    u_ = 0.9 * Vec3(solution.u[0], solution.u[1], solution.u[2]);
    solution.u = {u_.data(), 3};
    return status;
  }

 private:
  ActiveSet exact_;
  Flaw flaw_;
  Vec3 u_;
};

/// Exact, and takes down how many planes and rows it was given each time.
class Watchful final : public Solver {
 public:
  struct Given {
    std::size_t planes;
    Eigen::Index rows;
    bool operator==(const Given&) const = default;
  };
  explicit Watchful(std::vector<Given>& given) : given_(given) {}

  void reserve(int variables, int rows) override { exact_.reserve(variables, rows); }
  bool reads_planes() const noexcept override { return exact_.reads_planes(); }
  bool ignores_idle_planes() const noexcept override { return exact_.ignores_idle_planes(); }
  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override {
    given_.push_back({problem.planes.size(), problem.rows.rows()});
    return exact_.solve(problem, solution);
  }

 private:
  ActiveSet exact_;
  std::vector<Given>& given_;
};

class Measure : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    Random random(1);
    motions = contact_motions(*mesh, *tree, 500, {}, random);
    reference = std::make_unique<Reference>(guard, mesh, settings, motions);
  }

  BenchmarkRow measured(const std::shared_ptr<const SpatialIndex>& index,
                        std::unique_ptr<Solver> solver, double accuracy) {
    MotionConstraint constraint(mesh, index, make_activation(GetParam()), std::move(solver),
                                guard.options());
    BenchmarkRow row;
    measure(constraint, accuracy, motions, *reference, 10.0, stop, row);
    return row;
  }

  StopSignal stop;
  std::shared_ptr<const Mesh> mesh = mesh_of("cortex");
  std::shared_ptr<const SpatialIndex> tree =
      std::make_shared<QueriesOnly>(std::make_shared<PdTree>(mesh));
  MotionConstraintSettings settings{
      .activation = GetParam(),
      .options = {.radius = 1.0, .margin = std::string_view(GetParam()) == "certified" ? 0.2 : 0.0},
      .inside = Inside::taken_as_is};
  MotionConstraint guard = make_motion_constraint(mesh, tree, settings);
  std::vector<Motion> motions;
  std::unique_ptr<Reference> reference;
};

TEST_P(Measure, TimesWhatIsRight) {
  const BenchmarkRow row = measured(tree, std::make_unique<ActiveSet>(), 0.0);
  EXPECT_TRUE(row.verified);
  EXPECT_EQ(row.remark, "");
  EXPECT_EQ(row.queries, motions.size());
  ASSERT_TRUE(row.collect && row.query && row.activate && row.solve && row.step);
  ASSERT_TRUE(row.step_query) << "an index that only answers queries is not searched by a rule";
  EXPECT_EQ(row.step->samples, motions.size());
  EXPECT_GE(row.query->p50, row.collect->p50);
  EXPECT_GE(row.step->max, *row.step->p99);
  EXPECT_GE(row.candidates_mean, row.hits_mean);
  EXPECT_GT(row.hits_mean, 0.0);
  EXPECT_GT(row.planes_mean, 0.0);
  EXPECT_GT(row.reaching_share, 0.9);
  EXPECT_LE(row.reaching_share, 1.0);
  EXPECT_NE(row.hash, 0u);
}

TEST_P(Measure, DoesNotTimeAnIndexThatForgetsATriangle) {
  // One that is in reach of a motion that brute force is asked about.
  const std::size_t asked = 2 * motions.size() / 8;
  TriangleBuffer candidates(mesh->triangle_count());
  HitBuffer hits(mesh->triangle_count());
  tree->collect(reference->balls()[asked], candidates);
  refine(*mesh, reference->balls()[asked], candidates.view(), hits);
  ASSERT_FALSE(hits.empty());
  const BenchmarkRow row = measured(std::make_shared<Forgetful>(mesh, hits[0].triangle),
                                    std::make_unique<ActiveSet>(), 0.0);
  EXPECT_FALSE(row.verified);
  EXPECT_FALSE(row.step || row.collect);
  EXPECT_CONTAINS(row.remark, "not timed");
}

TEST_P(Measure, DoesNotTimeASolverThatErrsNowAndThen) {
  const BenchmarkRow row = measured(tree, std::make_unique<Flawed>(Flawed::Flaw::shorter), 1e-6);
  EXPECT_GT(row.worse_share, 0.005);
  // Under a rule that proves each motion they are right all the same.
  EXPECT_EQ(row.verified, reference->proves_motions());
  if (row.verified) return;
  EXPECT_FALSE(row.step);
  EXPECT_CONTAINS(row.remark, "not those of the reference");
}

TEST_P(Measure, CountsWhatASolverLeavesUnanswered) {
  const BenchmarkRow row = measured(tree, std::make_unique<Flawed>(Flawed::Flaw::gives_up), 1e-6);
  EXPECT_TRUE(row.verified);
  EXPECT_TRUE(row.step);
  EXPECT_GT(row.unsolved_share, 0.005);
  EXPECT_LT(row.unsolved_share, 0.2);
}

TEST_P(Measure, TakesAnyBitForADifferenceWhereNoneIsAllowed) {
  EXPECT_FALSE(measured(tree, std::make_unique<Flawed>(Flawed::Flaw::gives_up), 0.0).verified);
}

TEST_P(Measure, GivesTheSameHashForTheSameStepsOnly) {
  const std::uint64_t hash = measured(tree, std::make_unique<ActiveSet>(), 0.0).hash;
  EXPECT_EQ(measured(tree, std::make_unique<Flawed>(Flawed::Flaw::none), 0.0).hash, hash);
  EXPECT_NE(measured(tree, std::make_unique<Flawed>(Flawed::Flaw::gives_up), 1e-6).hash, hash);
}

TEST_P(Measure, VerifiesTheVeryStepsThatItTimes) {
  // Searched by the rule, which leaves planes out for a solver that says that it skips them.
  const auto index = std::make_shared<const WideBvh>(mesh);
  std::vector<Watchful::Given> given;
  const BenchmarkRow row = measured(index, std::make_unique<Watchful>(given), 0.0);
  ASSERT_TRUE(row.verified) << row.remark;
  // Stage by stage, and as a whole: in each round the solver is given the same.
  ASSERT_EQ(given.size() % 2, 0u);
  const auto half = given.begin() + static_cast<std::ptrdiff_t>(given.size() / 2);
  EXPECT_TRUE(std::equal(given.begin(), half, half, given.end()));
  // As the assembly that users have gives it.
  std::vector<Watchful::Given> shipped;
  MotionConstraint constraint(mesh, index, make_activation(GetParam()),
                              std::make_unique<Watchful>(shipped), guard.options());
  for (const Motion& motion : motions) constraint.step(motion);
  EXPECT_TRUE(std::equal(given.begin(), half, shipped.begin(), shipped.end()));
}

TEST_P(Measure, HasNoTimeOfAQueryThatTheRuleDoesNotMake) {
  const auto index = std::make_shared<const WideBvh>(mesh);
  const BenchmarkRow row = measured(index, std::make_unique<ActiveSet>(), 0.0);
  ASSERT_TRUE(row.verified) << row.remark;
  EXPECT_FALSE(row.step_query);
  // But of the query by itself, which is that of every index.
  const BenchmarkRow other = measured(tree, std::make_unique<ActiveSet>(), 0.0);
  ASSERT_TRUE(row.query && row.collect && other.step_query);
  EXPECT_GT(row.query->p50, row.collect->p50) << "the exact test and closest points are part of it";
  EXPECT_EQ(row.hits_mean, other.hits_mean);
  EXPECT_EQ(row.reaching_share, other.reaching_share);
  EXPECT_EQ(row.hash, other.hash);
}

/// Finds one triangle less, but only after so many answers.
class Tiring final : public SpatialIndex {
 public:
  Tiring(std::shared_ptr<const Mesh> mesh, int strength)
      : SpatialIndex(mesh), tree_(std::move(mesh)), left_(strength) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    tree_.collect(ball, candidates);
    if (--left_ < 0 && !candidates.empty()) candidates.begin()[0] = TriangleId{0};
  }
  std::size_t memory() const noexcept override { return tree_.memory(); }
  int left() const { return left_; }

 private:
  PdTree tree_;
  mutable int left_;
};

TEST_P(Measure, HoldsEveryQueryThatItTimesToTheReference) {
  constexpr int strength = 1 << 20;
  const auto fresh = std::make_shared<const Tiring>(mesh, strength);
  EXPECT_TRUE(measured(fresh, std::make_unique<ActiveSet>(), 0.0).verified);
  // Queries are the last that is asked of it: all but the last few are right.
  const auto tired = std::make_shared<const Tiring>(mesh, strength - fresh->left() - 50);
  const BenchmarkRow row = measured(tired, std::make_unique<ActiveSet>(), 0.0);
  EXPECT_FALSE(row.verified);
  EXPECT_FALSE(row.query || row.step);
  EXPECT_CONTAINS(row.remark, "queries do not find");
}

INSTANTIATE_TEST_SUITE_P(Rules, Measure, testing::Values("paper", "certified"), by_name);

}  // namespace
}  // namespace keepout::app
