// SPDX-License-Identifier: BSD-3-Clause
// A guide from a text is the one that is put together by hand.
#include "keepout/factory/guide_text.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "keepout/fixtures/random.h"
#include "messages.h"

namespace keepout {
namespace {

const Vec3 place(1, 2, 3);
const Vec3 way(0, 3, 4);

void expect_same(const Region& one, const Region& other) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Vec3 at = 10.0 * random.direction();
    EXPECT_EQ(one.excess(at), other.excess(at));
  }
}

TEST(GuideText, OfATipIsTheRegionMadeByHand) {
  for (const auto& [text, region] : std::vector<std::pair<std::string, Region>>{
           {"half_space:1,2,3:0,3,4", Region::half_space(place, way)},
           {"slab:1,2,3:0,3,4:0.5", Region::slab(place, way, 0.5)},
           {"tube:1,2,3:0,3,4:0.5", Region::tube(place, way, 0.5)},
           {"ball:1,2,3:0.5", Region::ball(place, 0.5)}}) {
    const Guide guide = guide_of_text("corridor=" + text);
    EXPECT_EQ(guide.name(), "corridor");
    EXPECT_EQ(guide.link(), 0);
    expect_same(guide.region(), region);
    EXPECT_EQ(guide_of_text(text).name(), text.substr(0, text.find(':')));
  }
}

TEST(GuideText, OfAnInstrumentIsTheGuideMadeByHand) {
  const Guide point = guide_of_text("tip=point:2:1,2,3:slab:1,2,3:0,3,4:0.5");
  EXPECT_EQ(point.name(), "tip");
  EXPECT_EQ(point.link(), 2);
  expect_same(point.region(), Region::slab(place, way, 0.5));
  const Guide axis = guide_of_text("axis:3:0,0,1:0,3,4:0.2");
  EXPECT_TRUE(axis.is_angular());
  expect_same(axis.region(), Guide::axis("", 3, Vec3::UnitZ(), way, 0.2).region());
  const Guide shaft = guide_of_text("remote_center:0:0,0,0:4:0,0,1:1,2,3:0.5");
  EXPECT_EQ(shaft.link(), 4);
  expect_same(shaft.region(), Region::ball(place, 0.5));
}

TEST(GuideText, WhatIsNoneIsToldWithTheForms) {
  for (const auto& [text, why] : std::vector<std::pair<std::string, std::string>>{
           {"", "its name is empty"},
           {"=ball:0,0,0:1", "its name is empty"},
           {"bal:0,0,0:1", "there is no such guide or region"},
           {"ball:0,0:1", "'0,0' is not a point"},
           {"ball:0,0,0:x", "'x' is not a number"},
           {"slab:0,0,0:0,0,0:1", "direction"}}) {
    const std::string told = error_of([&] { guide_of_text(text); });
    EXPECT_CONTAINS(told, why);
    EXPECT_CONTAINS(told, "half_space:X");
  }
  for (const auto& [text, why] : std::vector<std::pair<std::string, std::string>>{
           {"point:1.5:0,0,0:ball:0,0,0:1", "'1.5' is not the number of a link"},
           {"point:1:0,0,0:ball:0,0,0", "there is no such guide or region"},
           {"axle:1:0,0,1:0,0,1:0.1", "there is no such guide or region"}}) {
    const std::string told = error_of([&] { guide_of_text(text); });
    EXPECT_CONTAINS(told, why);
    EXPECT_CONTAINS(told, "point:LINK");
  }
}

}  // namespace
}  // namespace keepout
