// SPDX-License-Identifier: BSD-3-Clause
// Figures, sentences and moments of the record of a tip, and the strokes of its operator.

#include <cstdlib>

#include "meshes.h"
#include "messages.h"
#include "record/record.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "simulate/simulated_tool.h"
#include "trials.h"

namespace keepout::app {
namespace {

Cycle cycle(double clearance, float step_us = 0.0F, Outcome outcome = Outcome::moved_freely) {
  Cycle one;
  one.step_us = step_us;
  one.outcome = outcome;
  one.places.front() = Vec3(0.2, 0.2, -clearance);
  one.clearances.front() = clearance;
  return one;
}

using Cycles = std::vector<Cycle>;

/// Returns the cycles of a motion straight down, from 0.4 above a plane to `lowest` below it.
Cycles plunge(double lowest) {
  Cycles cycles;
  for (int i = 0; i <= 40; ++i) {
    const double height = 0.4 - (lowest + 0.4) * i / 40.0;
    cycles.push_back(cycle(height, i % 2 == 0 ? 2.0F : 4.0F));
  }
  return cycles;
}

/// Returns a stroke whose goals are the places of the first run, the one without a guard. Each
/// other run has its own rule.
FollowedStroke stroke_of(std::vector<Cycles> runs) {
  FollowedStroke followed{.stroke = {}, .runs = std::move(runs)};
  for (const Cycle& one : followed.runs.front()) {
    followed.stroke.goals.push_back({.position = one.places.front()});
  }
  return followed;
}

/// Returns the record of such strokes over a mesh.
Json record_of(const std::vector<FollowedStroke>& strokes, const char* mesh = "cube") {
  SimulateOptions options;
  options.meshes = {mesh};
  options.rules = {"certified", "paper"};
  options.rules.resize(strokes.front().runs.size() - 1);
  const auto tool = make_guarded_tip(options);
  tool->open(mesh, StopSignal());
  std::vector<RunTally> runs;
  for (const std::string& rule : tool->guards()) runs.push_back({.guard = rule});
  for (const FollowedStroke& followed : strokes) {
    for (std::size_t r = 0; r < runs.size(); ++r) runs[r].add(followed.runs[r], {.required = 0.05});
    tool->keep(followed);
  }
  return tool->result(runs).record;
}

/// Returns the part of the record for one run.
Json run_of(const std::vector<Cycles>& strokes, const char* mesh = "cube") {
  std::vector<FollowedStroke> followed;
  for (const Cycles& cycles : strokes) followed.push_back(stroke_of({cycles}));
  return record_of(followed, mesh)["runs"][0];
}

/// The tip goes in without a guard, stays out under the first rule, and gets in under the second.
const std::vector<Cycles> one_rule_fails{plunge(0.15), plunge(-0.05), plunge(0.02)};

TEST(Summary, FiguresAreThoseCountedByHand) {
  Cycles outside;
  for (int i = 1; i <= 8; ++i) {
    outside.push_back(cycle(0.5 * i, static_cast<float>(i), Outcome::limited));
  }
  Cycles inside{cycle(-0.25, 9.0F), cycle(-1.5, 10.0F, Outcome::stopped)};
  inside.front().is_breach = true;
  const Json run = run_of({outside, inside});
  EXPECT_FALSE(run["kept_out"]);
  EXPECT_EQ(run["summary"], (Json{{"strokes", 2},
                                  {"cycles", 10},
                                  {"rate_khz", 200.0},
                                  {"p50_us", 5.0},
                                  {"p99_us", 10.0},
                                  {"p999_us", 10.0},
                                  {"max_us", 10.0},
                                  {"closest_approach_mm", 0.0},
                                  {"deepest_mm", 1.5},
                                  {"cycles_inside", 2},
                                  {"strokes_inside", 1},
                                  {"crossings", 1},
                                  {"strokes_breached", 1},
                                  {"starts_too_close", 0},
                                  {"moved_freely", 1},
                                  {"limited", 8},
                                  {"stopped", 1}}));
}

TEST(Summary, ARunThatStaysOutsideTellsItsClosestApproach) {
  const Json run = run_of({plunge(-0.05)});
  EXPECT_DOUBLE_EQ(run["summary"]["closest_approach_mm"], 0.05);
  EXPECT_EQ(run["summary"]["deepest_mm"], 0.0);
  EXPECT_TRUE(run["kept_out"]);
}

TEST(Summary, AClearanceThatIsNotANumberCountsAgainstTheRule) {
  for (std::size_t body = 0; body < 3; ++body) {
    Cycle one = cycle(1.0);
    one.clearances[2] = 0.5;
    one.clearances[body] = test::nan;
    RunTally run;
    run.add({one}, {});
    EXPECT_EQ(run.any.in_mesh, 1U) << body;
    EXPECT_EQ(run.bodies[body].in_mesh, 1U) << body;
    EXPECT_FALSE(run.kept_out()) << body;
  }
}

TEST(Summary, ARunThatCrossedAnOpenSurfaceCameAsNearAsCanBe) {
  Cycles cycles(5, cycle(0.108));
  const auto closest = [&] {
    return run_of({cycles}, "flat_plate")["summary"]["closest_approach_mm"];
  };
  EXPECT_EQ(closest(), 0.108);
  cycles[1].is_breach = true;
  EXPECT_EQ(closest(), 0.0);
}

TEST(Text, IsAsciiForATerminalUnlessTheLocaleIsUtf8) {
  const std::string text = time_text(1.5) + ", " + length_text(0.0012345);
  EXPECT_EQ(text, "1.50 µs, 1.23 µm");
  EXPECT_EQ(in_ascii(text), "1.50 us, 1.23 um");
  const char* const set = std::getenv("LC_ALL");
  const std::string before = set == nullptr ? "" : set;  // empty if it is not set
  for (const auto& [locale, shown] : {std::pair("C", in_ascii(text)), std::pair("de_DE.utf8", text),
                                      std::pair("C.UTF-8", text)}) {
    ::setenv("LC_ALL", locale, 1);
    EXPECT_EQ(for_terminal(text), shown) << locale;
  }
  ::setenv("LC_ALL", before.c_str(), 1);
}

TEST(Text, NumbersReadWell) {
  EXPECT_EQ(time_text(12'345.0), "12.3 ms");
  EXPECT_EQ(time_text(2.5e7), "25.0 s");
  EXPECT_EQ(grouped(24000), "24,000");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(rounded(0.0012345), "0.00123");
  EXPECT_EQ(rounded(12.0), "12.0");
  EXPECT_EQ(trimmed(12.0), "12");
  EXPECT_EQ(trimmed(-0.5), "-0.5");
  EXPECT_EQ(trimmed(1200.0), "1200");
  EXPECT_EQ(trimmed(155.6996), "155.7");
  EXPECT_EQ(trimmed(1234567.8), "1234568");
  EXPECT_EQ(trimmed(-1e-17), "0");
  EXPECT_EQ(how_often(1), "once");
  EXPECT_EQ(how_often(2), "twice");
  EXPECT_EQ(how_often(1200), "1,200 times");
  EXPECT_EQ(length_text(1.2345), "1.23 mm");
  EXPECT_EQ(length_text(0.0012345), "1.23 µm");
  EXPECT_EQ(listed({"a", "b", "c"}), "a, b and c");
}

TEST(Verdict, NamesTheRulesThatFailAndHowDeep) {
  const Json record = record_of({stroke_of(one_rule_fails)});
  EXPECT_CONTAINS(record["headline"].get<std::string>(), "'paper' let the tool into");
  EXPECT_CONTAINS(record["headline"].get<std::string>(), "'certified' kept it out.");
  EXPECT_CONTAINS(record["runs"][2]["words"].get<std::string>(),
                  "0.0200 mm deep, in 1 of 1 stroke");
}

TEST(Verdict, SaysIfTheStrokesTestNoRule) {
  const Json record = record_of({stroke_of({plunge(-0.1), plunge(-0.1)})});
  EXPECT_CONTAINS(record["headline"].get<std::string>(), "these strokes test no rule");
}

TEST(Verdict, SaysIfARuleThatKeptTheToolOutTouchedOrCrossed) {
  const auto words = [](const std::vector<Cycles>& strokes) {
    return run_of(strokes, "flat_plate")["words"].get<std::string>();
  };
  EXPECT_CONTAINS(words({{cycle(0.0)}}), "touched");
  EXPECT_CONTAINS(words({{cycle(9e-7)}}), "touched");
  EXPECT_CONTAINS(words({{cycle(2e-6)}}), "2.00 nm");
  Cycles crossing(5, cycle(1.0));
  crossing[1].is_breach = true;
  EXPECT_CONTAINS(words({crossing, {cycle(1.0)}}), "once, in 1 of 2 strokes");
}

TEST(Verdict, SaysIfARuleWasNotTestedBecauseTheToolStoodStill) {
  const Cycles still(5, cycle(0.01, 1.0F, Outcome::stopped));
  const Json record = record_of({stroke_of({plunge(0.15), still, plunge(-0.05)})});
  const std::string headline = record["headline"].get<std::string>();
  EXPECT_CONTAINS(headline,
                  "Rule 'paper' kept the tool out of the anatomy. Rule 'certified' tested "
                  "nothing: the tool stood still in all ");
  EXPECT_CONTAINS(headline, "Without a fixture the tool went up to 0.1");
  EXPECT_EQ(record["runs"][1]["words"], "stood still in all 5 cycles");
  EXPECT_LACKS(headline, "began nearer");
}

TEST(Verdict, SaysHowLongTheToolStoodStillIfThatDiffers) {
  Cycles slow = plunge(-0.05);
  slow.front().outcome = Outcome::stopped;
  const auto headline = [&](const Cycles& second) {
    return record_of({stroke_of({plunge(0.15), slow, second})})["headline"].get<std::string>();
  };
  EXPECT_CONTAINS(
      headline(plunge(-0.05)),
      "Rules 'certified' and 'paper' kept the tool out of the anatomy; it stood still in 1 "
      "and 0 cycles.");
  EXPECT_CONTAINS(headline(slow),
                  "Rules 'certified' and 'paper' kept the tool out of the anatomy.");
}

TEST(Verdict, SaysIfStrokesBeganNearerThanTheRequiredClearance) {
  RunTally run;
  run.add({cycle(0.01)}, {.required = 0.2, .actual = 0.01});
  run.add({cycle(1.0)}, {.required = 0.2, .actual = 0.2});
  EXPECT_EQ(run.starts_too_close, 1u);
}

TEST(Moments, AreTheDeepestOrElseTheFirstCrossingOrElseTheNearest) {
  std::vector<Cycles> runs = one_rule_fails;
  const auto record = [&] { return record_of({stroke_of(runs)}); };
  EXPECT_EQ(record()["runs"][1]["worst"]["cycle"], 40);
  EXPECT_EQ(record()["moment"], (Json{{"run", 2}, {"stroke", 0}, {"cycle", 40}}))
      << "the rule that failed, though the tool went deeper without one";
  runs.pop_back();
  EXPECT_EQ(record()["moment"]["run"], 0) << "no rule failed";
  runs[1][7].is_breach = true;
  EXPECT_EQ(record()["runs"][1]["worst"]["cycle"], 7);
  EXPECT_EQ(record()["moment"]["run"], 1);
}

TEST(SimulationRecord, HasEveryCycleAndWhatIsSaidOfIt) {
  const Json record = record_of({stroke_of(one_rule_fails)});
  EXPECT_EQ(fault_of(record), "");
  ASSERT_EQ(record["runs"].size(), 3U);
  for (std::size_t r = 0; r < 3; ++r) {
    const Json& run = record["runs"][r];
    const Json& stroke = run["strokes"][0];
    const Cycles& cycles = one_rule_fails[r];
    ASSERT_EQ(stroke["tip"].size(), cycles.size());
    for (std::size_t c = 0; c < cycles.size(); ++c) {
      EXPECT_NEAR(stroke["tip"][c][2].get<double>(), cycles[c].places.front().z(), 0.51e-6);
      EXPECT_NEAR(stroke["clearance_mm"][c].get<double>(), cycles[c].least(), 0.51e-6);
      EXPECT_TRUE(r > 0 || record["hand"][0][c] == stroke["tip"][c]) << "without a fixture";
    }
    EXPECT_EQ(stroke["outcome"], std::string(cycles.size(), 'f'));
    EXPECT_EQ(run["kept_out"], r == 1);
  }
  EXPECT_TRUE(record["benchmark"].is_null());
}

TEST(SimulationRecord, OfAnOpenSurfaceTellsOfNoInside) {
  const Json record = record_of({stroke_of(one_rule_fails)}, "flat_plate");
  EXPECT_EQ(record["mesh"]["surface"], "open");
  EXPECT_TRUE(record["runs"][0]["summary"]["cycles_inside"].is_null());
  EXPECT_TRUE(record["runs"][0]["summary"]["deepest_mm"].is_null());
}

Audit audit_of(Surface surface) { return Audit(mesh_of(std::move(surface))); }

Surface inside_out(Surface surface) {
  for (Corners& corners : surface.triangles) std::swap(corners[0], corners[1]);
  return surface;
}

Surface joined(Surface one, const Surface& other) {
  const auto first = static_cast<VertexId>(one.vertices.size());
  one.vertices.insert(one.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (Corners corners : other.triangles) {
    for (VertexId& vertex : corners) vertex += first;
    one.triangles.push_back(corners);
  }
  return one;
}

/// Returns a shell. Much of its area is the wall of a cavity that is large enough for strokes.
Surface shell() {
  Surface cavity = make_concave_sphere(5.0);
  for (Vec3& vertex : cavity.vertices) vertex *= 0.8;
  return joined(make_sphere(5.0), cavity);
}

/// Returns twelve strokes of 200 cycles.
std::vector<std::vector<Pose>> strokes_over(Audit& audit, std::uint64_t seed = 1) {
  const auto next = tip_strokes(audit, {.seed = seed, .cycles = 200});
  std::vector<std::vector<Pose>> all;
  for (int i = 0; i < 12; ++i) all.push_back(next().goals);
  return all;
}

TEST(TipStrokes, GoFromFreeSpaceThroughTheSurfaceAndBack) {
  struct Case {
    const char* name;
    Surface surface;
    double (*height)(const Vec3&);  // above the surface, on its free side
    double start, lowest;
  };
  const auto z = [](const Vec3& tip) { return tip.z(); };
  for (const auto& [name, surface, height, start, lowest] : std::vector<Case>{
           {"a cube", make_cube(10.0),
            [](const Vec3& tip) { return tip.cwiseAbs().maxCoeff() - 50.0; }, 5.0, 0.0},
           {"a flat sheet, from its free side", make_flat_plate(5.0, 1), z, 5.0, 0.0},
           {"a single triangle", {{{0, 0, 0}, {100, 0, 0}, {0, 100, 0}}, {{0, 1, 2}}}, z, 5.0, 0.0},
           {"a sphere that keeps the tool inside", make_concave_sphere(5.0),
            [](const Vec3& tip) { return 50.0 - tip.norm(); }, 4.0, 0.5},
           {"a shell, whose places that face outwards are preferred", shell(),
            [](const Vec3& tip) { return tip.norm() - 50.0; }, 0.0, 0.5}}) {
    SCOPED_TRACE(name);
    Audit audit = audit_of(surface);
    for (const std::vector<Pose>& goals : strokes_over(audit)) {
      ASSERT_EQ(goals.size(), 200u);
      EXPECT_GT(height(goals.front().position), start);
      EXPECT_GT(height(goals.back().position), start - 1.0);
      EXPECT_LT(height(goals[60].position), lowest);
      for (const Pose& goal : goals) ASSERT_TRUE(goal.position.allFinite());
    }
  }
}

TEST(TipStrokes, OfTheSameSeedAreAlike) {
  Audit audit = audit_of(make_cube(10.0));
  const auto last = [&](std::uint64_t seed) {
    return strokes_over(audit, seed).back().back().position;
  };
  EXPECT_EQ(last(1), last(1));
  EXPECT_NE(last(1), last(2));
}

TEST(TipStrokes, WithoutRoomAnywhereTheErrorNamesTheRemedy) {
  Audit audit = audit_of(inside_out(make_thin_plates(10.0)));  // free: inside a plate, 1 mm
  const std::string message = error_of([&] { strokes_over(audit); });
  for (const char* word : {"no free place", "8 mm of free space", "flip", "keepout inspect"}) {
    EXPECT_CONTAINS(message, word);
  }
}

}  // namespace
}  // namespace keepout::app
