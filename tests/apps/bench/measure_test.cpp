// SPDX-License-Identifier: BSD-3-Clause
// Wrong answers are not timed, whichever part is wrong, and however rarely.
#include <bit>
#include <functional>

#include "bench/bench.h"
#include "keepout/activation/registry.h"
#include "keepout/fixtures/motions.h"
#include "keepout/fixtures/queries_only.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/solvers/active_set.h"
#include "meshes.h"
#include "messages.h"
#include "trials.h"

namespace keepout::app {
namespace {

/// An index that is right, except where `spoil` changes its answers.
class Spoiled final : public SpatialIndex {
 public:
  Spoiled(std::shared_ptr<const Mesh> mesh, std::function<void(TriangleBuffer&)> spoil)
      : SpatialIndex(mesh), tree_(std::move(mesh)), spoil_(std::move(spoil)) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    tree_.collect(ball, candidates);
    spoil_(candidates);
  }
  std::size_t memory() const noexcept override { return tree_.memory(); }

 private:
  PdTree tree_;
  std::function<void(TriangleBuffer&)> spoil_;
};

/// An exact solver. `watch` receives each answer, and may change it.
class Watched final : public Solver {
 public:
  using Watch = std::function<SolveStatus(const StepProblem&, Solution&, SolveStatus)>;
  explicit Watched(Watch watch) : watch_(std::move(watch)) {}

  void reserve(int variables, int rows) override { exact_.reserve(variables, rows); }
  bool reads_planes() const noexcept override { return exact_.reads_planes(); }
  bool ignores_idle_planes() const noexcept override { return exact_.ignores_idle_planes(); }
  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override {
    return watch_(problem, solution, exact_.solve(problem, solution));
  }

 private:
  ActiveSet exact_;
  Watch watch_;
};

enum class Flaw { shorter, gives_up, none };

/// Returns a solver that is wrong, or fails, at a few problems: always the same ones.
std::unique_ptr<Solver> flawed(Flaw flaw) {
  return std::make_unique<Watched>([flaw, u = Vec3{0, 0, 0}](const StepProblem& problem,
                                                             Solution& solution,
                                                             SolveStatus status) mutable {
    const auto bits = std::bit_cast<std::uint64_t>(problem.desired[0]);
    if (status != SolveStatus::optimal || bits % 50 != 0 || flaw == Flaw::none) return status;
    if (flaw == Flaw::gives_up) return SolveStatus::iteration_limit;
    u = 0.9 * Vec3(solution.u[0], solution.u[1], solution.u[2]);
    solution.u = {u.data(), 3};
    return status;
  });
}

/// The numbers of planes and rows of each problem that a solver was given.
using Given = std::vector<std::pair<std::size_t, Eigen::Index>>;

std::unique_ptr<Solver> taking_down(Given& given) {
  return std::make_unique<Watched>(
      [&given](const StepProblem& problem, Solution&, SolveStatus status) {
        given.emplace_back(problem.planes.size(), problem.rows.rows());
        return status;
      });
}

class Measure : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    Random random(1);
    motions = contact_motions(*mesh, *tree, 1000, {}, random);
    reference = std::make_unique<Reference>(tree, mesh, settings, motions);
  }

  BenchmarkRow measured(const std::shared_ptr<const SpatialIndex>& index,
                        std::unique_ptr<Solver> solver, double accuracy) {
    MotionConstraint constraint(mesh, index, make_activation(GetParam()), std::move(solver),
                                settings.options);
    BenchmarkRow row = new_row();
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
  std::vector<Motion> motions;
  std::unique_ptr<Reference> reference;
};

TEST_P(Measure, TimesWhatIsRight) {
  const BenchmarkRow row = measured(tree, std::make_unique<ActiveSet>(), 0.0);
  EXPECT_TRUE(row["verified"]);
  EXPECT_FALSE(row["wrong"]);
  EXPECT_EQ(row["remark"], "");
  EXPECT_EQ(row["queries"], motions.size());
  for (const char* stage : {"collect_us", "query_us", "activate_us", "solve_us", "step_us"}) {
    ASSERT_FALSE(row[stage].is_null()) << stage;
    ASSERT_FALSE(row[stage]["p999"].is_null()) << stage << ": of all 1000";
    EXPECT_GE(row[stage]["max"], row[stage]["p99"]) << stage;
  }
  ASSERT_FALSE(row["step_query_us"].is_null())
      << "an index that only answers queries is not searched by a rule";
  EXPECT_GE(row["query_us"]["p50"], row["collect_us"]["p50"]);
  EXPECT_EQ(row["rate_khz"], 1e3 / row["step_us"]["p50"].get<double>());
  EXPECT_GE(row["candidates_mean"], row["hits_mean"]);
  EXPECT_GT(row["hits_mean"], 0.0);
  EXPECT_GT(row["planes_mean"], 0.0);
  EXPECT_GT(row["reaching_share"], 0.9);
  EXPECT_LE(row["reaching_share"], 1.0);
  EXPECT_NE(row["hash"], new_row()["hash"]);
}

TEST_P(Measure, DoesNotTimeAnIndexThatForgetsATriangle) {
  // A triangle in reach of a motion that brute force solves as well.
  TriangleBuffer candidates(mesh->triangle_count());
  HitBuffer hits(mesh->triangle_count());
  for (std::size_t sample = 0; sample < 8 && hits.empty(); ++sample) {
    const Ball& ball = reference->balls()[sample * motions.size() / 8];
    candidates.clear();
    tree->collect(ball, candidates);
    refine(*mesh, ball, candidates.view(), hits);
  }
  ASSERT_FALSE(hits.empty());
  const auto forget = [forgotten = hits[0].triangle](TriangleBuffer& found) {
    std::replace(found.begin(), found.end(), forgotten, TriangleId{0});
  };
  const BenchmarkRow row =
      measured(std::make_shared<Spoiled>(mesh, forget), std::make_unique<ActiveSet>(), 0.0);
  EXPECT_FALSE(row["verified"]);
  EXPECT_TRUE(row["wrong"]);
  EXPECT_TRUE(row["step_us"].is_null() && row["collect_us"].is_null());
  EXPECT_CONTAINS(plain(row["remark"]), "not timed");
}

TEST_P(Measure, DoesNotTimeASolverThatErrsNowAndThen) {
  const BenchmarkRow row = measured(tree, flawed(Flaw::shorter), 1e-6);
  EXPECT_GT(row["worse_share"], 0.005);
  // Under a rule that proves each motion, the results are right nevertheless.
  EXPECT_EQ(row["verified"], reference->proves_motions());
  EXPECT_NE(row["wrong"], row["verified"]);
  if (row["verified"]) return;
  EXPECT_TRUE(row["step_us"].is_null());
  EXPECT_CONTAINS(plain(row["remark"]), "not those of the reference");
}

TEST_P(Measure, CountsWhatASolverLeavesUnanswered) {
  const BenchmarkRow row = measured(tree, flawed(Flaw::gives_up), 1e-6);
  EXPECT_TRUE(row["verified"]);
  EXPECT_FALSE(row["step_us"].is_null());
  EXPECT_GT(row["unsolved_share"], 0.005);
  EXPECT_LT(row["unsolved_share"], 0.2);
  EXPECT_EQ(row["remark"] == "", row["unsolved_share"] <= 0.01) << row["unsolved_share"];
}

TEST_P(Measure, TakesAnyBitForADifferenceWhereNoneIsAllowed) {
  EXPECT_FALSE(measured(tree, flawed(Flaw::gives_up), 0.0)["verified"]);
}

TEST_P(Measure, GivesTheSameHashForTheSameStepsOnly) {
  const Json hash = measured(tree, std::make_unique<ActiveSet>(), 0.0)["hash"];
  EXPECT_EQ(measured(tree, flawed(Flaw::none), 0.0)["hash"], hash);
  EXPECT_NE(measured(tree, flawed(Flaw::gives_up), 1e-6)["hash"], hash);
}

TEST_P(Measure, VerifiesTheVeryStepsThatItTimes) {
  // The rule traverses this index. It leaves planes out for a solver that ignores idle planes.
  const auto index = std::make_shared<const WideBvh>(mesh);
  Given given;
  const BenchmarkRow row = measured(index, taking_down(given), 0.0);
  ASSERT_TRUE(row["verified"]) << row["remark"];
  // Stage by stage, and as a whole: the solver receives the same problems in both rounds.
  ASSERT_EQ(given.size() % 2, 0u);
  const auto half = given.begin() + static_cast<std::ptrdiff_t>(given.size() / 2);
  EXPECT_TRUE(std::equal(given.begin(), half, half, given.end()));
  // An assembly as users make it gives the solver the same problems.
  Given shipped;
  MotionConstraint constraint(mesh, index, make_activation(GetParam()), taking_down(shipped),
                              settings.options);
  for (const Motion& motion : motions) constraint.step(motion);
  EXPECT_TRUE(std::equal(given.begin(), half, shipped.begin(), shipped.end()));
}

TEST_P(Measure, HasNoTimeOfAQueryThatTheRuleDoesNotMake) {
  const auto index = std::make_shared<const WideBvh>(mesh);
  const BenchmarkRow row = measured(index, std::make_unique<ActiveSet>(), 0.0);
  ASSERT_TRUE(row["verified"]) << row["remark"];
  EXPECT_TRUE(row["step_query_us"].is_null());
  // The query by itself is timed, as with every index.
  const BenchmarkRow other = measured(tree, std::make_unique<ActiveSet>(), 0.0);
  ASSERT_FALSE(row["query_us"].is_null() || other["step_query_us"].is_null());
  EXPECT_GT(row["query_us"]["p50"], row["collect_us"]["p50"])
      << "the exact test and closest points are part of it";
  EXPECT_EQ(row["hits_mean"], other["hits_mean"]);
  EXPECT_EQ(row["reaching_share"], other["reaching_share"]);
  EXPECT_EQ(row["hash"], other["hash"]);
}

TEST_P(Measure, HoldsEveryQueryThatItTimesToTheReference) {
  constexpr int strength = 1 << 20;
  int left = strength;  // right answers, before one triangle is missing
  const auto tiring = std::make_shared<const Spoiled>(mesh, [&left](TriangleBuffer& found) {
    if (--left < 0 && !found.empty()) found.begin()[0] = TriangleId{0};
  });
  EXPECT_TRUE(measured(tiring, std::make_unique<ActiveSet>(), 0.0)["verified"]);
  // Queries are measured last, so only the last few answers are wrong.
  left = strength - left - 50;
  const BenchmarkRow row = measured(tiring, std::make_unique<ActiveSet>(), 0.0);
  EXPECT_FALSE(row["verified"]);
  EXPECT_TRUE(row["wrong"]);
  EXPECT_TRUE(row["query_us"].is_null() && row["step_us"].is_null());
  EXPECT_CONTAINS(plain(row["remark"]), "queries do not find");
}

INSTANTIATE_TEST_SUITE_P(Rules, Measure, testing::Values("paper", "certified"), by_name);

}  // namespace
}  // namespace keepout::app
