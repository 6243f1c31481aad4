// SPDX-License-Identifier: BSD-3-Clause
// A convex tool or a guide from a text equals the one put together by hand.

#include "factory/tools_by_name.h"
#include "keepout/factory/guide_text.h"
#include "keepout/keepout.h"
#include "temporary_folder.h"

namespace keepout {
namespace {

void expect_same(const ConvexTool& one, const ConvexTool& other) {
  EXPECT_EQ(std::vector<Vec3>(one.points().begin(), one.points().end()),
            std::vector<Vec3>(other.points().begin(), other.points().end()));
  EXPECT_EQ(one.radius(), other.radius());
}

TEST(ConvexToolByName, EachTextIsTheToolMadeByHand) {
  for (const auto& [text, tool] : test::tools_by_name()) {
    SCOPED_TRACE(text);
    expect_same(tool_of_text(text), tool);
  }
  const TemporaryFolder folder;
  const std::string file =
      folder.write("1,2,3:4.off", "OFF\n4 2 0\n0 0 0\n3 0 0\n0 3 0\n0 0 3\n3 0 1 2\n3 0 1 3\n");
  const std::vector<Vec3> corners{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}};
  expect_same(tool_of_text("hull:" + file), ConvexTool::hull(corners));
}

TEST(ConvexToolByName, ATextThatIsNoToolIsToldWithTheForms) {
  for (const auto& [text, why] : std::vector<std::pair<std::string, std::string>>{
           {"", "the tool '': there is no such form"},
           {"box:4,4,20", "'box' has too few or too many fields"},
           {"sphere:nan", "'nan' is not a number"},
           {"sphere:-1", "the radius of a convex tool"},
           {"capsule:0,0:0,0,1:1", "'0,0' is not a point"},
           {"blade:4:2:0", "of a blade must be above 0"},
           {"hull:0,0,0:1,1:2", "'1,1' is not a point"},
           {"hull:/none.stl", "there is no file '/none.stl'"},
           {"hull:" + testing::TempDir(), "there is no file"}}) {
    const std::string told = error_of([&] { tool_of_text(text); });
    EXPECT_CONTAINS(told, why);
    EXPECT_CONTAINS(told, "write sphere:R or capsule:");
  }
}

TEST(ConvexToolByName, AMangledTextIsAToolOrAnErrorAndNothingElse) {
  Random random(6);
  const std::string letters = ":,.-+019e naxh\n";
  int tools = 0;
  for (int i = 0; i < 2000; ++i) {
    for (auto [text, tool] : test::tools_by_name()) {
      for (int changes = 0; changes < 2; ++changes) {
        text[random.below(text.size())] = letters[random.below(letters.size())];
      }
      tools += error_of([&] { tool_of_text(text); }) == "no error";
    }
  }
  EXPECT_GT(tools, 100);
}

// The steps of different narrow phases hardly ever differ. The test of a wrong name below shows
// that names are looked up.
TEST(ConvexToolByName, StepsOnEachNarrowPhaseAsPutTogetherByHandBitForBit) {
  for (const NarrowPhaseBackend& backend : narrow_phase_backends()) {
    for (const auto& [text, tool] : test::tools_by_name()) {
      SCOPED_TRACE(std::string(backend.name) + " " + text);
      const std::string name(backend.name);
      MotionConstraint guard =
          make_motion_constraint(test::cube(), {.tool = tool_of_text(text), .narrow_phase = name});
      int held = 0;
      for (const auto& expected : test::loop_by_hand(tool, name, name == "exact" ? 400 : 40)) {
        const Step step = guard.step({.tip = expected.tip, .desired = expected.desired});
        EXPECT_EQ(step.status, expected.status);
        EXPECT_EQ(step.motion, expected.motion);
        held += step.status == Status::limited;
      }
      EXPECT_GT(held, 5);
    }
  }
}

TEST(ConvexToolByName, IsTakenAsItIsInsideAndRefusedWhereSettingsContradictEachOther) {
  const ConvexTool tool = ConvexTool::sphere(1.0);
  MotionConstraint guard = make_motion_constraint(test::cube(), {.tool = tool});
  EXPECT_EQ(guard.step({.tip = {0, 0, 0}, .desired = {0, 0, 1}}).motion, Vec3(0, 0, 1));
  for (const auto& [settings, why] : std::vector<std::pair<MotionConstraintSettings, std::string>>{
           {{.options = {.tool_radius = 0.5}, .tool = tool}, "leave tool_radius at 0"},
           {{.activation = "paper", .tool = tool}, "leave activation at 'certified', not 'paper'"},
           {{.narrow_phase = "ccd_mpr"}, "'ccd_mpr' is for a convex tool"},
           {{.tool = tool, .narrow_phase = "exakt"}, "did you mean 'exact'"}}) {
    const std::string told = error_of([&] { make_motion_constraint(test::cube(), settings); });
    EXPECT_CONTAINS(told, why);
  }
}

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
           {"point:1:0,0,0:ball:0,0,0", "'ball' has too few or too many fields"},
           {"axle:1:0,0,1:0,0,1:0.1", "there is no such guide or region"}}) {
    const std::string told = error_of([&] { guide_of_text(text); });
    EXPECT_CONTAINS(told, why);
    EXPECT_CONTAINS(told, "point:LINK");
  }
}

}  // namespace
}  // namespace keepout
