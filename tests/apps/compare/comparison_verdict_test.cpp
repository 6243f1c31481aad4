// SPDX-License-Identifier: BSD-3-Clause
// The verdict of a comparison: whether the parts agree, and the figures of those that do not.
#include <gtest/gtest.h>

#include "compare/comparison.h"
#include "messages.h"

namespace keepout::app {
namespace {

Comparison two_indices() {
  Comparison comparison;
  for (const char* index : {"wide_bvh", "pd_tree"}) {
    for (const char* rule : {"paper", "certified"}) {
      comparison.indices.push_back({.mesh = "cube",
                                    .index = index,
                                    .activation = rule,
                                    .searched = std::string(index) == "wide_bvh",
                                    .poses = 50});
    }
  }
  return comparison;
}

TEST(ComparisonVerdict, NamesWhatIsWrong) {
  Comparison comparison = two_indices();
  EXPECT_TRUE(agree(comparison));
  EXPECT_CONTAINS(verdict(comparison).front(), "Of 200 queries");
  comparison.indices[2].missed = 4;
  comparison.indices[2].steps_that_differ = 1;
  EXPECT_FALSE(agree(comparison));
  EXPECT_CONTAINS(index_verdict(comparison.indices), "pd_tree missed 4 triangles; 1 step differs");
  comparison = two_indices();
  comparison.solvers.push_back({.solver = "active_set", .activation = "paper", .wrong = 1});
  EXPECT_FALSE(agree(comparison));
}

TEST(ComparisonVerdict, CountsTheProblemsOfASlowSolver) {
  const auto row = [](const char* solver, const char* rule, std::size_t problems, double us) {
    return SolverAgreement{.solver = solver,
                           .activation = rule,
                           .posed = 1000,
                           .problems = problems,
                           .optimal = problems,
                           .median_us = us};
  };
  const std::string text = solver_verdict(
      {row("active_set", "paper", 1000, 0.5), row("nlopt_cobyla", "paper", 100, 50.0),
       row("active_set", "certified", 1000, 0.1), row("nlopt_cobyla", "certified", 100, 40.0)});
  EXPECT_CONTAINS(text, "nlopt_cobyla got 100 of 1,000");
  EXPECT_CONTAINS(text, "100 to 400 times as long");
}

TEST(ComparisonVerdict, CountsPairsThatTouchApartFromThoseThatDoNot) {
  EXPECT_EQ(std::stod(touch_text), touch);
  const auto row = [](const char* backend, const char* relation, std::size_t contradicted) {
    return NarrowPhaseAgreement{.backend = backend,
                                .tool = "box",
                                .relation = relation,
                                .pairs = 2000,
                                .contradicted = contradicted};
  };
  const std::string text =
      narrow_phase_verdict({row("fcl_gjk", "apart", 20), row("fcl_gjk", "touching", 1005),
                            row("fcl_gjk", "overlapping", 8), row("libccd_gjk", "touching", 3)});
  EXPECT_CONTAINS(text, "28 times, and fcl_gjk and libccd_gjk 1,008 times more");
  EXPECT_LACKS(narrow_phase_verdict({row("exact", "touching", 0)}), "touch to within");
}

TEST(ComparisonVerdict, OfAnInterruptedComparisonClaimsNoMoreThanWasFinished) {
  Comparison comparison = two_indices();
  comparison.complete = false;
  const std::vector<std::string> text = verdict(comparison);
  EXPECT_CONTAINS(text[text.size() - 2], "4 rows were finished");
  EXPECT_TRUE(text.back().starts_with("So far"));
  comparison.indices.clear();
  EXPECT_CONTAINS(verdict(comparison).back(), "0 rows were finished") << "nothing agreed";
}

}  // namespace
}  // namespace keepout::app
