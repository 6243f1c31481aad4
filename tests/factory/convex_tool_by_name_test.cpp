// SPDX-License-Identifier: BSD-3-Clause
// A convex tool by name is the one that is put together by hand.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "factory/tools_by_name.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/keepout.h"
#include "temporary_folder.h"
#include "trials.h"

namespace keepout {
namespace {

void expect_same(const ConvexTool& one, const ConvexTool& other) {
  EXPECT_EQ(std::vector<Vec3>(one.points().begin(), one.points().end()),
            std::vector<Vec3>(other.points().begin(), other.points().end()));
  EXPECT_EQ(one.radius(), other.radius());
}

/// What is said of a text; empty if it is a tool's.
std::string objection(const std::string& text) {
  try {
    tool_of_text(text);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

std::shared_ptr<const Mesh> cube() {
  static const auto shared = std::make_shared<const Mesh>(make_cube(10.0));
  return shared;
}

/// Lets a tool by name and the same by hand follow the hand, and counts the cycles that held it.
int held_in_loop(const test::ToolByName& named, const std::string& narrow_phase, int cycles) {
  MotionConstraint guard = make_motion_constraint(
      cube(), {.tool = tool_of_text(named.text), .narrow_phase = narrow_phase});
  MotionConstraint own = test::by_hand(cube(), named.tool, narrow_phase);
  int held = 0;
  Vec3 tip(3, 4, 56);
  for (const Vec3& goal : test::hand_over_cube(cycles)) {
    const Vec3 desired = 0.5 * (goal - tip);
    const Step expected = own.step({.tip = tip, .desired = desired});
    const Vec3 motion = expected.motion;
    const Step step = guard.step({.tip = tip, .desired = desired});
    EXPECT_EQ(step.status, expected.status);
    EXPECT_EQ(step.motion, motion);
    EXPECT_EQ(step.planes.size(), expected.planes.size());
    held += step.status == Status::limited;
    tip += step.motion;
  }
  return held;
}

TEST(ConvexToolText, EachFormIsTheToolMadeByHand) {
  for (const auto& [text, tool] : test::tools_by_name()) {
    SCOPED_TRACE(text);
    expect_same(tool_of_text(text), tool);
  }
  expect_same(tool_of_text("box:1,0.5,0.25:-1,-0.5,-0.25"),
              tool_of_text("box:-1,-.5,-.25:1,.5,.25"));
}

TEST(ConvexToolText, AFileIsTheHullOfItsVertices) {
  const TemporaryFolder folder;
  const std::string file = folder.write("1,2,3:4.off",
                                        "OFF\n4 2 0\n0 0 0\n3 0 0\n0 3 0\n0 0 3\n"
                                        "3 0 1 2\n3 0 1 3\n");
  const std::vector<Vec3> corners{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}};
  expect_same(tool_of_text("hull:" + file), ConvexTool::hull(corners));
  const std::string broken = folder.write("broken.off", "OFF\n4 2\n");
  EXPECT_NE(objection("hull:" + broken).find("broken.off"), std::string::npos);
}

TEST(ConvexToolText, WhatIsNoToolIsToldWithTheFormThatWasMeant) {
  const std::string mesh = (std::filesystem::path(testing::TempDir()) / "none.stl").string();
  for (const auto& [text, why, form] : std::vector<std::array<std::string, 3>>{
           {"", "there is no tool ''", "sphere:R, capsule:"},
           {"spere:1", "there is no tool 'spere'", "sphere:R"},
           {"sphere", "'' is not a number", "sphere:R"},
           {"sphere:", "'' is not a number", "sphere:R"},
           {"sphere:2mm", "'2mm' is not a number", "sphere:R"},
           {"sphere:nan", "'nan' is not a number", "sphere:R"},
           {"sphere:inf", "'inf' is not a number", "sphere:R"},
           {"sphere:1e999", "'1e999' is not a number", "sphere:R"},
           {"sphere: 1", "' 1' is not a number", "sphere:R"},
           {"sphere:-1", "radius", "sphere:R"},
           {"sphere:1:2", "there are 2 values where there must be 1", "sphere:R"},
           {"capsule:0,0,0:1", "there are 2 values where there must be 3", "capsule:X,Y,Z:X,Y,Z:R"},
           {"capsule:0,0:0,0,1:1", "'0,0' is not a point", "capsule:"},
           {"capsule:0,0,0:0,,1:1", "'' is not a number", "capsule:"},
           {"box:0,0,0", "there are 1 values where there must be 2", "box:X,Y,Z:X,Y,Z"},
           {"blade:4:2", "there are 2 values where there must be 3", "blade:LENGTH:WIDTH"},
           {"blade:4:2:0", "'0' is not above 0", "blade:"},
           {"blade:-4:2:1", "'-4' is not above 0", "blade:"},
           {"hull:0,0,0:1,1:2", "'1,1' is not a point", "hull:X,Y,Z:...[:R] or hull:FILE"},
           {"hull:0,0,0:-2", "radius", "hull:"},
           {"hull:", "there is no file ''", "hull:"},
           {"hull:" + mesh, "there is no file '" + mesh + "'", "hull:"},
           {"hull:" + testing::TempDir(), "there is no file", "hull:"}}) {
    const std::string told = objection(text);
    EXPECT_NE(told.find(why), std::string::npos) << text << "\n" << told;
    EXPECT_NE(told.find("write " + form), std::string::npos) << text << "\n" << told;
    EXPECT_NE(told.find(", not '" + text + "'"), std::string::npos) << told;
  }
  std::string many = "hull:0,0,0";
  for (int i = 1; i <= 64; ++i)
    many += ":" + std::to_string(i) + "," + std::to_string(i * i) + ",0";
  EXPECT_NE(objection(many).find("1 to 64 points"), std::string::npos);
}

TEST(ConvexToolText, AMangledTextIsAToolOrAnErrorAndNothingElse) {
  Random random(6);
  const std::string letters = ":,.-+0123456789e naxhulspb\n";
  int tools = 0;
  int errors = 0;
  for (int i = 0; i < test::trials(20'000); ++i) {
    for (const auto& [text, tool] : test::tools_by_name()) {
      std::string mangled = text;
      for (std::uint64_t changes = 1 + random.below(3); changes > 0; --changes) {
        const std::size_t at = random.below(mangled.size());
        const char letter = letters[random.below(letters.size())];
        if (random.below(2) == 0)
          mangled[at] = letter;
        else
          mangled.insert(at, 1, letter);
      }
      const bool is_tool = objection(mangled).empty();
      tools += is_tool;
      errors += !is_tool;
    }
  }
  EXPECT_GT(tools, test::trials(10'000));
  EXPECT_GT(errors, test::trials(10'000));
}

TEST(ConvexToolByName, StepsAsPutTogetherByHandBitForBit) {
  for (const test::ToolByName& named : test::tools_by_name()) {
    SCOPED_TRACE(named.text);
    EXPECT_GT(held_in_loop(named, "exact", 400), 50);
  }
}

TEST(ConvexToolByName, StepsOnEachNarrowPhaseAsByHand) {
  for (const NarrowPhaseBackend& backend : narrow_phase_backends()) {
    for (const test::ToolByName& named : test::tools_by_name()) {
      SCOPED_TRACE(std::string(backend.name) + " " + named.text);
      EXPECT_GT(held_in_loop(named, std::string(backend.name), 40), 5);
    }
  }
}

TEST(ConvexToolByName, AToolThatStartsInsideIsTakenAsItIs) {
  MotionConstraint guard = make_motion_constraint(cube(), {.tool = ConvexTool::sphere(1.0)});
  const Step step = guard.step({.tip = {0, 0, 0}, .desired = {0, 0, 1}});
  EXPECT_EQ(step.status, Status::free);
  EXPECT_EQ(step.motion, Vec3(0, 0, 1));
  EXPECT_EQ(guard.free_polytope({0, 0, 60}, 1.0).status, PolytopeStatus::whole_tool);
}

TEST(ConvexToolByName, SettingsThatContradictEachOtherAreRefused) {
  const ConvexTool tool = ConvexTool::sphere(1.0);
  for (const auto& [settings, told] : std::vector<std::pair<MotionConstraintSettings, std::string>>{
           {{.tool_radius = 0.5, .tool = tool}, "leave tool_radius at 0"},
           {{.activation = "paper", .tool = tool}, "leave activation at 'certified', not 'paper'"},
           {{.narrow_phase = "ccd_mpr"}, "'ccd_mpr' is for a convex tool"},
           {{.tool = tool, .narrow_phase = "exakt"}, "did you mean 'exact'"},
           {{.tool = tool, .margin = 0.0}, "margin is too small"}}) {
    try {
      make_motion_constraint(cube(), settings);
      ADD_FAILURE() << told;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(told), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace keepout
