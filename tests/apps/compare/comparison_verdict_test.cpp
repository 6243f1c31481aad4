// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>

#include "compare/comparison.h"

namespace keepout::app {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

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

TEST(ComparisonVerdict, SaysThatAllAgreeAndWhatCouldNotBeOtherwise) {
  const Comparison comparison = two_indices();
  EXPECT_TRUE(agree(comparison));
  const std::string text = verdict(comparison).front();
  EXPECT_TRUE(has(text, "Of 200 queries")) << text;
  EXPECT_TRUE(has(text, "all 2 indices give brute force's steps, bit for bit")) << text;
  EXPECT_TRUE(has(text, "By construction the exact kernel decides")) << text;
  EXPECT_TRUE(has(text, "which is what paper and certified do on wide_bvh")) << text;
  EXPECT_EQ(verdict(comparison).back(), "All parts agree that must.");
}

TEST(ComparisonVerdict, NamesWhatIsWrong) {
  Comparison comparison = two_indices();
  comparison.indices[2].missed = 4;
  comparison.indices[2].steps_that_differ = 1;
  EXPECT_FALSE(agree(comparison));
  const std::string text = index_verdict(comparison.indices);
  EXPECT_TRUE(has(text, "pd_tree missed 4 triangles; 1 step differs from brute force's")) << text;
  EXPECT_TRUE(has(verdict(comparison).back(), "please report it"));

  comparison = two_indices();
  comparison.solvers.push_back({.solver = "active_set", .activation = "paper", .wrong = 1});
  EXPECT_FALSE(agree(comparison));
}

TEST(ComparisonVerdict, SaysWhyASolverGotFewerProblems) {
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
  EXPECT_TRUE(
      has(text,
          "nlopt_cobyla got 100 of 1,000 under each rule, evenly spread, as it takes 100 to "
          "400 times as long as active_set."))
      << text;
  EXPECT_FALSE(has(text, "Each solver got the same")) << "it did not: " << text;
  EXPECT_TRUE(has(solver_verdict({row("active_set", "paper", 1000, 0.5)}),
                  "Each solver got the same recorded problems"));
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
  const std::vector<NarrowPhaseAgreement> both = {row("fcl_gjk", "apart", 20),
                                                  row("fcl_gjk", "touching", 1005),
                                                  row("fcl_gjk", "overlapping", 8)};
  EXPECT_TRUE(has(narrow_phase_verdict(both),
                  "fcl_gjk took apart for overlapping, or the reverse, 28 times, and 1,005 times "
                  "more where the two touch to within 1e-6 mm, and all gave an answer."))
      << narrow_phase_verdict(both);
  std::vector<NarrowPhaseAgreement> others = both;
  others.push_back(row("libccd_gjk", "touching", 3));
  EXPECT_TRUE(has(narrow_phase_verdict(others),
                  "28 times, and fcl_gjk and libccd_gjk 1,008 times more where the two touch"))
      << narrow_phase_verdict(others);
  EXPECT_TRUE(has(narrow_phase_verdict({row("fcl_gjk", "apart", 0), row("fcl_gjk", "touching", 2)}),
                  "none called apart what overlaps, or the reverse; fcl_gjk did so twice where the "
                  "two touch to within 1e-6 mm, and all gave an answer."));
  EXPECT_FALSE(has(narrow_phase_verdict({row("exact", "touching", 0)}), "touch to within"));
}

TEST(ComparisonVerdict, OfAnInterruptedComparisonClaimsNoMoreThanWasFinished) {
  Comparison comparison = two_indices();
  comparison.complete = false;
  const std::vector<std::string> text = verdict(comparison);
  EXPECT_TRUE(has(text[text.size() - 2], "Interrupted: 4 rows were finished"));
  EXPECT_EQ(text.back(), "So far all parts agree that must.");
  comparison.indices.clear();
  EXPECT_TRUE(has(verdict(comparison).back(), "0 rows were finished")) << "nothing agreed";
}

}  // namespace
}  // namespace keepout::app
