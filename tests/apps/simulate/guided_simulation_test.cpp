// SPDX-License-Identifier: BSD-3-Clause
// keepout simulate --guide and --tool: an independent judge follows the tool, and the record has
// its findings.

#include "apps/command_process.h"
#include "keepout/factory/convex_tool_text.h"
#include "keepout/factory/guide_text.h"
#include "keepout/geometry/separation.h"
#include "meshes.h"
#include "shared/columns.h"
#include "simulate/guide_audit.h"
#include "simulate/tally.h"
#include "simulate/tool_audit.h"
#include "trials.h"

namespace keepout::app {
namespace {

Json record_of(const test::CommandFolder& folder, const std::string& arguments) {
  succeeded(folder.run("simulate " + arguments + " --json r.json --out r.html"));
  std::ifstream file(folder.file("r.json"));
  return Json::parse(file);
}

const Json& run_of(const Json& record, const char* rule) {
  for (const Json& run : record["runs"]) {
    if (run["rule"] == rule) return run;
  }
  return record["runs"][99];
}

TEST(SimulateGuides, EveryRuleKeepsTheTipInAndTheHandAloneDoesNot) {
  const test::CommandFolder folder;
  const Json record = record_of(folder,
                                "cube --strokes 4 --cycles 400 --guide corridor=slab:0,0,0:1,0,0:4 "
                                "--guide half_space:0,0,20:0,0,1 --tool-radius 1");
  EXPECT_EQ(record["guides"].size(), 2U);
  EXPECT_CONTAINS(record["headline"].get<std::string>(), "left no guide by more than promised");
  EXPECT_CONTAINS(record["settings"]["guides"].get<std::string>(), "corridor=slab");
  ASSERT_EQ(record["runs"].size(), 4U);
  for (const Json& run : record["runs"]) {
    const bool is_free = run["rule"] == "none";
    EXPECT_EQ(run["summary"]["guides_left"] > 0, is_free) << run["summary"];
    EXPECT_EQ(run["summary"]["farthest_out_mm"] > 0.0021, is_free) << run["summary"];
    double farthest = -100.0;
    for (const Json& stroke : run["strokes"]) {
      for (const Json& tip : stroke["tip"]) {
        farthest =
            std::max({farthest, std::abs(tip[0].get<double>()) - 4.0, 20.0 - tip[2].get<double>()});
      }
    }
    EXPECT_NEAR(run["summary"]["farthest_out_mm"].get<double>(), farthest, 1e-5);
    EXPECT_CONTAINS(run["words"].get<std::string>(), is_free ? "left a guide in" : "left no guide");
  }
}

TEST(SimulateGuides, AGuideThatNoStrokeWasInsideTestsNothing) {
  const test::CommandFolder folder;
  const std::string far = "ball:0,0,500:1", wide = "ball:0,0,0:500";
  for (const std::string robot : {"", " --robot psm --speed 5"}) {
    const auto in_form = [&](const std::string& region) {
      return robot.empty() ? region : "point:6:0,0,0:" + region;
    };
    const std::string strokes = "cube --strokes 2 --cycles 100" + robot + " --guide ";
    test::ProcessOutcome outside = folder.run("simulate " + strokes + in_form(far));
    EXPECT_EQ(outside.status, 1) << outside.output;
    std::ranges::replace(outside.output, '\n', ' ');  // the terminal's line breaks
    EXPECT_CONTAINS(outside.output, "tested nothing");
    const auto headline = [&](const std::string& guides) {
      return record_of(folder, strokes + guides)["headline"].get<std::string>();
    };
    EXPECT_CONTAINS(headline(in_form(wide) + " --guide " + in_form(far)),
                    " Guide '" + in_form(far) + "' tested nothing: no stroke was ever inside it.");
    EXPECT_LACKS(headline(in_form(wide)), "tested nothing");
  }
}

TEST(SimulateGuides, ATipThatLeavesAGuideIsSeen) {
  const std::vector<Guide> guides{guide_of_text("slab:0,0,0:1,0,0:1"),
                                  guide_of_text("ball:0,0,0:9")};
  GuideAudit audit(guides, Vec3(0, 0, 0));
  EXPECT_FALSE(audit.follow(Vec3(1.0019, 0, 0))) << "within the band";
  EXPECT_DOUBLE_EQ(audit.excess(), 1.0019 - 1.0);
  EXPECT_TRUE(audit.follow(Vec3(1.0021, 0, 0)));
  EXPECT_TRUE(audit.follow(Vec3(0, 0, -9.1)));
  GuideAudit outside(guides, Vec3(3, 0, 0));
  EXPECT_FALSE(outside.follow(Vec3(3, 1, 0))) << "no farther out";
  EXPECT_FALSE(outside.follow(Vec3(2, 0, 0)));
  EXPECT_TRUE(outside.follow(Vec3(2.1, 0, 0))) << "farther out than it came back";
  EXPECT_EQ(GuideAudit({}, Vec3(0, 0, 0)).excess(), -Cycle::far);
}

TEST(SimulateTool, TheWholeToolIsKeptOffAndTheHandAloneTouches) {
  const test::CommandFolder folder;
  for (const char* tool : {"blade:20:6:1", "capsule:0,0,0:0,0,15:1.5"}) {
    SCOPED_TRACE(tool);
    const Json record = record_of(
        folder, std::string("cube --strokes 3 --cycles 300 --margin 0.25 --tool ") + tool);
    EXPECT_TRUE(record["has_convex_tool"]);
    EXPECT_CONTAINS(record["headline"].get<std::string>(), "kept the whole tool off the surface");
    ASSERT_EQ(record["runs"].size(), 2U) << "a tool has one rule";
    EXPECT_GT(run_of(record, "none")["summary"]["crossings"], 20U);
    const Json& guarded = run_of(record, "certified");
    EXPECT_EQ(guarded["summary"]["crossings"], 0U);
    EXPECT_GT(guarded["summary"]["limited"], 20U);
    EXPECT_NEAR(guarded["summary"]["closest_approach_mm"].get<double>(), 0.25, 1e-6);
    EXPECT_CONTAINS(guarded["description"].get<std::string>(), "convex tools");
  }
}

TEST(SimulateTool, TheJudgeMeasuresWhatTheExactKernelDoesAndSeesEachTouch) {
  Audit audit(mesh_of(make_cube(10.0)));  // from -50 to 50
  Random random(5);
  std::vector<Vec3> points;
  for (int i = 0; i < 30; ++i) points.push_back(4.0 * random.direction());
  for (const ConvexTool& tool :
       {tool_of_text("blade:20:6:1"), tool_of_text("sphere:2"),
        tool_of_text("capsule:1,0,0:0,9,0:1.5"), ConvexTool::hull(points, 0.5)}) {
    ToolAudit path(audit, tool, Vec3(0, 0, 80));
    Vec3 tip(0, 0, 80);
    for (int i = 0; i < test::trials(200); ++i) {
      tip += random.uniform(0.0, 3.0) * random.direction() - Vec3(0, 0, 0.15);
      if (path.follow(tip)) break;
      double least = Cycle::far;
      for (TriangleId t = 0; t < audit.mesh().triangle_count(); ++t) {
        least = std::min(least, separation(tool, tip, audit.mesh().triangle(t)).distance);
      }
      EXPECT_NEAR(path.clearance(), least, 1e-8);
    }
  }
  const ConvexTool blade = tool_of_text("blade:20:6:1");  // x from -3 to 3
  ToolAudit beside(audit, blade, Vec3(53.5, 0, 0));
  EXPECT_DOUBLE_EQ(beside.clearance(), 0.5);
  EXPECT_FALSE(beside.follow(Vec3(53.1, 30, 0)));
  EXPECT_TRUE(beside.follow(Vec3(52.9, 30, 0)));
  ToolAudit through(audit, blade, Vec3(60, 0, 0));
  EXPECT_TRUE(through.follow(Vec3(-60, 0, 0))) << "clear at both ends, but not between";
  EXPECT_DOUBLE_EQ(through.clearance(), 7.0);
  EXPECT_TRUE(through.follow(Vec3(0, 0, 0)));
  EXPECT_DOUBLE_EQ(through.clearance(), -30.0) << "wholly inside, 20 to the top at the nearest";
}

TEST(SimulateGuides, OfAnInstrumentAreKeptInEachModeThatHasThem) {
  const test::CommandFolder folder;
  const Json record = record_of(
      folder,
      "gear --robot psm --strokes 3 --cycles 200 --speed 5 --guide axis:6:0,1,0:0,0,1:2.5 "
      "--guide tip=point:6:0,10.2,0:half_space:0,0,0:0,0,1");
  EXPECT_CONTAINS(record["headline"].get<std::string>(), "off the anatomy, and in its guides");
  std::size_t left = 0;
  for (const Json& row : record["rows"]) {
    EXPECT_TRUE(row["mode"] != "certified" || row["guides_left"] == 0U) << row;
    if (row["mode"] == "none") left += row["guides_left"].get<std::size_t>();
  }
  EXPECT_GT(left, 0U);
}

/// Removes the members that differ between runs: times, and properties of the machine.
Json without_times(Json record) {
  for (const char* name : {"date", "command", "machine", "account"}) record.erase(name);
  for (Json& run : record["runs"]) {
    for (const char* name : {"rate_khz", "p50_us", "p99_us", "p999_us", "max_us"}) {
      run["summary"].erase(name);
    }
    for (Json& stroke : run["strokes"]) stroke.erase("step_us");
  }
  return record;
}

TEST(SimulateTool, TwoRunsWithGuidesDifferInTimesOnly) {
  const test::CommandFolder folder;
  for (const char* extent : {"--refine 3", "--refine 0 --branches 3"}) {
    const std::string arguments = std::string(
                                      "cube --strokes 3 --cycles 200 --guide slab:0,0,0:1,0,0:4 "
                                      "--guide half_space:0,0,20:0,0,1 --tool blade:20:6:1 ") +
                                  extent;
    const Json first = record_of(folder, arguments);
    EXPECT_TRUE(without_times(first) == without_times(record_of(folder, arguments))) << extent;
    const Json& summary = run_of(first, "certified")["summary"];
    EXPECT_EQ(summary["crossings"], 0U) << extent;
    EXPECT_EQ(summary["guides_left"], 0U) << extent;
    EXPECT_GT(summary["limited"], 20U) << extent;
  }
}

TEST(SimulateGuides, AMonitorChangesNoStepThatItConfirms) {
  const test::CommandFolder folder;
  const std::string arguments = "cube --strokes 3 --cycles 200 --guide slab:0,0,0:1,0,0:4 ";
  Json monitored = record_of(folder, arguments + "--monitor true");
  EXPECT_EQ(monitored["settings"].erase("monitor"), 1U);
  EXPECT_TRUE(without_times(monitored) == without_times(record_of(folder, arguments)));
  EXPECT_CONTAINS(folder.run("simulate cube --tool blade:20:6:1 --monitor true").output,
                  "a monitor confirms the motions of a ball");
}

TEST(SimulateGuides, TellOfMistakes) {
  const test::CommandFolder folder;
  for (const auto& [arguments, told] : std::initializer_list<std::pair<const char*, const char*>>{
           {"cube --guide slab:0,0:1,0,0:1", "'0,0' is not a point"},
           {"cube --guide a=axis:6:0,0,1:0,0,1:1",
            "--guide: 'a=axis:6:0,0,1:0,0,1:1' is for a link of an instrument, but this is a tip"},
           {"cube --robot psm --guide ball:0,0,0:9",
            "--guide: 'ball:0,0,0:9' is for a tip, but this is an instrument"},
           {"cube --robot psm --tool sphere:1", "--tool and --robot cannot be given together"},
           {"cube --tool blade:1:1", "the tool 'blade'"},
           {"cube --tool sphere:1 --activation paper", "cannot be given together"},
           {"cube --tool sphere:1 --tool-radius 1", "cannot be given together"}}) {
    folder.expect_refused(std::string("simulate ") + arguments, told);
  }
}

}  // namespace
}  // namespace keepout::app
