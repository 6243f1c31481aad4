// SPDX-License-Identifier: BSD-3-Clause
#include "compare/compare.h"

#include <csignal>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "apps/command_process.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/solvers/active_set.h"
#include "keepout/solvers/registry.h"
#include "keepout/version.h"
#include "meshes.h"
#include "messages.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

using nlohmann::json;
using test::CommandFolder;
using test::ProcessOutcome;
using test::succeeded;

IndexComparison on_a_cube() {
  return {.mesh_name = "cube",
          .mesh = mesh_of(make_cube(5.0)),
          .indices = {"wide_bvh", "pd_tree"},
          .activations = {"all_faces", "paper", "certified"},
          .poses = 30};
}

TEST(IndexAgreement, StepsTheFormsThatAreShipped) {
  std::size_t asked = 0;
  const auto rows = compare_indices(on_a_cube(), [&] { return ++asked == 0; });
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(asked, 3u * 3 * 30) << "of brute force and of each index, under each rule";
  for (const IndexAgreement& row : rows) {
    SCOPED_TRACE(row.index + " " + row.activation);
    // wide_bvh offers a traversal along motions; both indices offer their triangles in blocks.
    const bool offers = row.activation == "certified"
                            ? row.index == "wide_bvh"
                            : row.activation == "paper" && row.index != "fcl_obbrss";
    EXPECT_EQ(row.searched, offers);
    EXPECT_EQ(row.poses, 30u);
    EXPECT_EQ(row.missed + row.invented + row.steps_that_differ, 0u);
    EXPECT_LT(row.closest_point_error, 1e-12);
  }
}

TEST(IndexAgreement, KeepsTheRowsThatWereFinishedWhenItIsStopped) {
  std::size_t asked = 0;
  const auto rows = compare_indices(on_a_cube(), [&] { return ++asked > 30 * 3 + 30 + 7; });
  ASSERT_EQ(rows.size(), 1u) << "brute force, and the first index under the first rule";
  EXPECT_EQ(rows.front().index, "wide_bvh");
  EXPECT_EQ(rows.front().poses, 30u);
}

TEST(Compare, EndsAtOnceWhenTheSignalHasCome) {
  std::signal(SIGINT, SIG_DFL);  // it is ignored if tests run in the background
  const StopSignal stop;
  ASSERT_EQ(std::raise(SIGINT), 0);
  const IndexComparison on = on_a_cube();
  const Comparison comparison =
      compare_parts(on.mesh_name, on.mesh, {}, [&stop] { return stop.has_come(); });
  EXPECT_FALSE(comparison.complete);
  EXPECT_TRUE(comparison.indices.empty() && comparison.solvers.empty() &&
              comparison.narrow_phases.empty());
}

TEST(NarrowPhaseAgreement, EveryNarrowPhaseIsHeldToTheSamePairs) {
  const Mesh mesh(make_sphere(3.0));
  const auto rows = compare_narrow_phases(mesh, 40, 1);
  ASSERT_EQ(rows.size(), 4 * 3 * narrow_phase_backends().size());
  std::set<std::string> backends, tools, relations;
  for (const NarrowPhaseAgreement& row : rows) {
    SCOPED_TRACE(row.backend + " " + row.tool + " " + row.relation);
    backends.insert(row.backend);
    tools.insert(row.tool);
    relations.insert(row.relation);
    EXPECT_EQ(row.pairs, 40u);
    EXPECT_LE(row.failed + row.contradicted, row.pairs);
    EXPECT_LE(row.median_error, row.worst_error);
    EXPECT_GT(row.us.p50, 0.0);
    EXPECT_LE(row.us.p50, row.us.p99.value_or(row.us.max));
    if (row.backend != "exact") continue;
    EXPECT_EQ(row.failed + row.contradicted, 0u);
    EXPECT_EQ(row.worst_error, 0.0);
    EXPECT_LT(row.worst_unproven, 1e-13);
  }
  EXPECT_EQ(backends.size(), narrow_phase_backends().size());
  EXPECT_EQ(tools, (std::set<std::string>{"sphere", "capsule", "box", "hull"}));
  EXPECT_EQ(relations, (std::set<std::string>{"apart", "touching", "overlapping"}));
}

std::shared_ptr<const Mesh> cortex() {
  static const auto mesh = mesh_of("cortex");
  return mesh;
}

TEST(RecordedProblems, AreTheSameForTheSameSeedAndHaveRows) {
  const auto first = record_problems(cortex(), "certified", 60, 3);
  const auto second = record_problems(cortex(), "certified", 60, 3);
  ASSERT_EQ(first.size(), 60u);
  ASSERT_EQ(second.size(), 60u);
  Eigen::Index rows = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].rows, second[i].rows);
    EXPECT_EQ(first[i].desired, second[i].desired);
    rows += first[i].rows.rows();
  }
  EXPECT_GT(rows, 30);
}

TEST(RecordedProblems, AreThoseUntilItIsStopped) {
  std::size_t asked = 0;
  const auto stopped = [&] { return ++asked > 5; };
  const auto problems = record_problems(cortex(), "certified", 1'000'000, 3, stopped);
  EXPECT_EQ(asked, 6u) << "before each stroke";
  EXPECT_FALSE(problems.empty());
  EXPECT_LT(problems.size(), 1000u);
}

TEST(NarrowPhaseAgreement, MakesNoPairsAfterItIsStopped) {
  EXPECT_TRUE(
      compare_narrow_phases(Mesh(make_sphere(3.0)), 1'000'000, 1, [] { return true; }).empty());
}

TEST(RecordedProblems, AContradictionLeavesNoSolution) {
  Random random(5);
  ActiveSet solver;
  solver.reserve(7, 4000);
  for (RecordedProblem& problem : record_problems(cortex(), "all_faces", 100, 4)) {
    contradict(problem, random);
    Solution solution;
    EXPECT_EQ(solver.solve(problem.view(), solution), SolveStatus::infeasible);
  }
}

TEST(SolverAgreement, CountsEveryProblemOnceAndNoSolverIsWrong) {
  SolverComparison comparison{
      .rules = {"certified", "paper"}, .solvers = {}, .problems = 120, .seed = 2, .most = {}};
  for (const SolverBackend& backend : solver_backends()) {
    comparison.solvers.emplace_back(backend.name);
    if (backend.library != nullptr) comparison.most[comparison.solvers.back()] = 20;
  }
  const std::vector<SolverAgreement> rows = compare_solvers(cortex(), comparison);
  ASSERT_EQ(rows.size(), 2 * comparison.solvers.size());
  for (const SolverAgreement& row : rows) {
    EXPECT_EQ(row.problems, row.solver == "active_set" ? 120u : 20u) << row.solver;
    EXPECT_EQ(row.optimal + row.infeasible + row.gave_up, row.problems) << row.solver;
    EXPECT_EQ(row.wrong, 0u) << row.solver << ", " << row.activation;
    EXPECT_GT(row.optimal, row.problems / 2) << row.solver << ", " << row.activation;
    EXPECT_LE(row.us.p50, row.us.p99.value_or(row.us.max));
    const std::size_t outcomes =
        std::accumulate(row.outcomes.begin(), row.outcomes.end(), std::size_t{0},
                        [](std::size_t sum, const auto& entry) { return sum + entry.second; });
    EXPECT_EQ(outcomes, row.problems) << row.solver;
  }
}

TEST(SolverAgreement, AnUnknownSolverIsNamed) {
  const SolverComparison comparison{
      .rules = {"certified"}, .solvers = {"simplex"}, .problems = 10, .most = {}};
  EXPECT_THROW(compare_solvers(cortex(), comparison), Error);
}

TEST(ComparisonFindings, PartsAgreeUnlessAnIndexDiffersOrASolverIsWrong) {
  EXPECT_EQ(std::stod(touch_text), touch);
  Comparison all;
  for (const char* index : {"wide_bvh", "pd_tree"}) {
    all.indices.push_back({.index = index, .activation = "paper", .poses = 50});
  }
  all.solvers.push_back({.solver = "active_set", .activation = "paper", .problems = 7});
  all.narrow_phases.push_back(
      {.backend = "fcl_gjk", .tool = "box", .relation = "apart", .contradicted = 20});
  EXPECT_TRUE(agree(all));
  EXPECT_CONTAINS(headline(all), "100 comparisons");
  EXPECT_CONTAINS(headline(all), "7 problems");
  const struct {
    const char* figure;
    void (*spoil)(Comparison&);
  } cases[] = {{"4 missed", [](Comparison& c) { c.indices[1].missed = 4; }},
               {"3 invented", [](Comparison& c) { c.indices[1].invented = 3; }},
               {"1 different step,", [](Comparison& c) { c.indices[1].steps_that_differ = 1; }},
               {"2.0e-09 rad", [](Comparison& c) { c.indices[1].plane_angle = 2e-9; }},
               {"1 wrong answer.", [](Comparison& c) { c.solvers[0].wrong = 1; }}};
  for (const auto& [figure, spoil] : cases) {
    Comparison comparison = all;
    spoil(comparison);
    EXPECT_FALSE(agree(comparison)) << figure;
    EXPECT_FALSE(json_of(comparison)["agree"]) << figure;
    EXPECT_CONTAINS(headline(comparison), figure);
  }
  all.complete = false;
  EXPECT_TRUE(headline(all).starts_with("Interrupted"));
  EXPECT_LACKS(headline(Comparison{}), "All indices") << "nothing was compared";
}

/// keepout compare, as a user runs it.
class CompareCommand : public testing::Test {
 protected:
  void SetUp() override { write_binary_stl(folder.file("cube.stl"), make_cube(5.0)); }

  json read(const std::string& name) const { return json::parse(folder.contents(name)); }

  CommandFolder folder;
};

TEST_F(CompareCommand, HoldsEveryIndexToBruteForceAndWritesHowToDoItAgain) {
  const std::string arguments =
      "compare cube.stl --poses 30 --problems 60 --pairs 20 --seed 3 --json c.json";
  const ProcessOutcome outcome = succeeded(folder.run(arguments));
  const json record = read("c.json");
  const json& comparison = record["comparison"];
  std::set<std::string> names, searched;
  for (const json& row : comparison["indices"]["rows"]) {
    names.insert(row["index"]);
    if (row["searched_by_the_rule"]) searched.insert(row["index"]);
    EXPECT_EQ(row["poses"], 30);
    EXPECT_EQ(row["missed"], 0);
    EXPECT_EQ(row["invented"], 0);
    EXPECT_EQ(row["steps_that_differ"], 0);
    EXPECT_LT(row["closest_point_error_mm"], 1e-12);
  }
  EXPECT_EQ(names.size(), index_backends().size() - 1);
  EXPECT_EQ(searched, (std::set<std::string>{"pd_tree", "wide_bvh"}))
      << "that is the form that users run";
  EXPECT_EQ(comparison["agree"], true);
  EXPECT_CONTAINS(outcome.output, record["headline"].get<std::string>());
  EXPECT_EQ(record["command"], "keepout " + arguments);
  EXPECT_EQ(record["seed"], 3);
  EXPECT_EQ(record["mesh"], "cube.stl");
  EXPECT_EQ(record["complete"], true);
  EXPECT_EQ(record["machine"]["keepout"], KEEPOUT_VERSION);
  EXPECT_FALSE(record["machine"]["processor"].get<std::string>().empty());
  EXPECT_EQ(record["date"].get<std::string>().size(), std::string("2026-01-01T00:00:00Z").size());
}

TEST_F(CompareCommand, KeepsWhatIsFinishedWhenItIsInterrupted) {
  const ProcessOutcome outcome =
      folder.run("compare cube.stl --poses 6 --problems 200000 --pairs 10 --json c.json",
                 "timeout --foreground --preserve-status --signal=INT 3");
  EXPECT_EQ(outcome.status, 130) << outcome.output;
  EXPECT_CONTAINS(outcome.output, "Interrupted");
  const json comparison = read("c.json")["comparison"];
  EXPECT_EQ(comparison["complete"], false);
  EXPECT_EQ(comparison["agree"], true);
  EXPECT_FALSE(comparison["indices"].empty()) << "they were finished";
  EXPECT_TRUE(comparison["narrow_phases"].empty());
}

}  // namespace
}  // namespace keepout::app
