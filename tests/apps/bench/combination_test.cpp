// SPDX-License-Identifier: BSD-3-Clause
#include "bench/combination.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/solvers/registry.h"

namespace keepout::app {
namespace {

std::ptrdiff_t count(const std::vector<Combination>& all, auto predicate) {
  return std::ranges::count_if(all, predicate);
}

TEST(Combinations, OfNothingAskedForHaveEveryIndexAndEverySolver) {
  const std::vector<Combination> all = combinations_of({});
  std::set<std::string> seen_indices, seen_rules, seen_solvers;
  for (const Combination& c : all) {
    seen_indices.insert(c.index);
    seen_rules.insert(c.activation);
    seen_solvers.insert(c.solver);
  }
  EXPECT_EQ(seen_indices.size(), index_backends().size() - 1) << "all but the oracle";
  EXPECT_EQ(seen_rules.size(), activation_rules().size());
  EXPECT_EQ(seen_solvers.size(), solver_backends().size());
}

TEST(Combinations, StandOnceEachAndThoseOfAnIndexTogether) {
  const std::vector<Combination> all = combinations_of({});
  std::set<std::string> left_behind;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(count(all, [&](const Combination& c) { return c == all[i]; }), 1);
    if (i > 0 && all[i].index != all[i - 1].index) left_behind.insert(all[i - 1].index);
    EXPECT_FALSE(left_behind.contains(all[i].index)) << "would be built twice";
  }
}

TEST(Combinations, CrossWhatWasAskedForAndTakeTheReferenceForTheRest) {
  const std::vector<Combination> all = combinations_of(
      {.indices = {"pd_tree", "brute_force"}, .activations = {}, .solvers = {}, .radii = {2.0}});
  const std::vector<Combination> expected = {{"brute_force", "paper", "active_set", 2.0},
                                             {"brute_force", "certified", "active_set", {}},
                                             {"pd_tree", "paper", "active_set", 2.0},
                                             {"pd_tree", "certified", "active_set", {}}};
  EXPECT_EQ(all, expected);
}

TEST(Combinations, ListTheCertifiedRuleOnceWhateverTheRadii) {
  const std::vector<Combination> all = combinations_of(
      {.indices = {}, .activations = {"certified"}, .solvers = {}, .radii = {5.0, 1.0}});
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].radius, std::nullopt);
}

TEST(Combinations, OfAQuickLookAreFewer) {
  const std::vector<Combination> quick = combinations_of({.radii = {5.0, 1.0}});
  EXPECT_LT(quick.size(), combinations_of({}).size());
  EXPECT_GE(quick.size(), 5u);
}

}  // namespace
}  // namespace keepout::app
