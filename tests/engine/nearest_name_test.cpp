// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>

#include "keepout/registry.h"
#include "messages.h"

namespace keepout {
namespace {

constexpr std::array<std::string_view, 6> rules_and_indices = {
    "certified", "all_faces", "paper", "wide_bvh", "bullet", "bullet_quantized"};

TEST(NearestName, IsOneLetterAwayFromTheOneThatWasMeant) {
  for (const std::string_view mistyped : {"papr", "papper", "paber", "papre", "Paper", "paper"}) {
    EXPECT_EQ(nearest_name(mistyped, rules_and_indices), "paper") << mistyped;
  }
}

TEST(NearestName, IsTheOneWithTheFewestEdits) {
  constexpr std::array<std::string_view, 3> words = {"stone", "stove", "store"};
  EXPECT_EQ(nearest_name("stovee", words), "stove");
  EXPECT_EQ(nearest_name("stoe", words), "stone") << "of equals the first";
  EXPECT_EQ(nearest_name("sotre", words), "store") << "a swap is one edit, not two";
}

TEST(NearestName, IsTheOneThatWasMeant) {
  EXPECT_EQ(nearest_name("certifed", rules_and_indices), "certified");
  EXPECT_EQ(nearest_name("all-faces", rules_and_indices), "all_faces");
  EXPECT_EQ(nearest_name("widebvh", rules_and_indices), "wide_bvh");
  EXPECT_EQ(nearest_name("Bulet", rules_and_indices), "bullet");
  EXPECT_EQ(nearest_name("quantized", rules_and_indices), "bullet_quantized") << "a piece of it";
}

TEST(NearestName, IsNothingWhereNoNameIsClose) {
  EXPECT_EQ(nearest_name("nonsense", rules_and_indices), std::nullopt);
  EXPECT_EQ(nearest_name("", rules_and_indices), std::nullopt);
  EXPECT_EQ(nearest_name("a", rules_and_indices), std::nullopt) << "which is in most names";
  EXPECT_EQ(nearest_name("paper", {}), std::nullopt);
}

TEST(Registry, AsksWhetherTheNearestNameWasMeant) {
  struct Part {
    std::string_view name;
  };
  constexpr std::array<Part, 2> parts = {Part{"certified"}, Part{"paper"}};
  constexpr std::array<AbsentPart, 1> absent = {AbsentPart{"embree", "Embree"}};
  const auto refusal = [&](std::string_view name) {
    return error_of([&] { Registry<Part>("rule", parts, absent).named(name); });
  };
  EXPECT_EQ(refusal("paper"), "no error");
  EXPECT_EQ(refusal("certifed"),
            "there is no rule 'certifed'; did you mean 'certified'? known: certified, paper");
  EXPECT_EQ(refusal("embre"),
            "there is no rule 'embre'; did you mean 'embree'? known: certified, paper");
  EXPECT_EQ(refusal("nonsense"), "there is no rule 'nonsense'; known: certified, paper");
}

}  // namespace
}  // namespace keepout
