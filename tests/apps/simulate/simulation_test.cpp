// SPDX-License-Identifier: BSD-3-Clause
// Figures, sentences and moments of a simulation's record.
#include "simulate/simulation.h"

#include "meshes.h"
#include "messages.h"
#include "record/record.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "simulate/hand.h"
#include "trials.h"

namespace keepout::app {
namespace {

Cycle cycle(const Vec3& tip, double clearance, float step_us = 0.0F,
            Outcome outcome = Outcome::moved_freely) {
  return {tip, tip, clearance, step_us, outcome};
}

/// A stroke straight down at (0.2, 0.2), from above the base of the tetrahedron to a given height.
/// Clearance is that to the base alone, which is the nearest face here.
Stroke plunge(double lowest) {
  Stroke stroke;
  for (int i = 0; i <= 40; ++i) {
    const double height = -0.4 + (lowest + 0.4) * i / 40.0;
    stroke.cycles.push_back(cycle({0.2, 0.2, height}, -height, i % 2 == 0 ? 2.0F : 4.0F));
  }
  return stroke;
}

/// The base of the tetrahedron is the plane z = 0; free space is below it.
Simulation tetrahedron_simulation(const Mesh& mesh) {
  Simulation simulation{.mesh_name = "<tetra> & \"friends\"", .mesh = &mesh, .margin = 0.05};
  simulation.runs.push_back({.rule = no_rule, .description = "", .strokes = {plunge(0.15)}});
  simulation.runs.push_back({.rule = "safe", .description = "a < b", .strokes = {plunge(-0.05)}});
  simulation.runs.push_back({.rule = "leaky", .description = "", .strokes = {plunge(0.02)}});
  simulation.settings = {{"seed", "<1>"}};
  return simulation;
}

TEST(Summary, FiguresAreThoseCountedByHand) {
  app::Run run{.rule = "some", .description = ""};
  Stroke outside, inside;
  for (int i = 1; i <= 8; ++i) {
    outside.cycles.push_back(cycle({0, 0, 0}, 0.5 * i, static_cast<float>(i), Outcome::limited));
  }
  inside.cycles = {cycle({0, 0, 0}, -0.25, 9.0F), cycle({0, 0, 0}, -1.5, 10.0F, Outcome::stopped)};
  run.strokes = {outside, inside};
  run.crossings = {{1, 0}};

  const RunSummary s = summarize(run);
  EXPECT_EQ(s.strokes, 2U);
  EXPECT_EQ(s.cycles, 10U);
  EXPECT_EQ(s.moved_freely, 1U);
  EXPECT_EQ(s.limited, 8U);
  EXPECT_EQ(s.stopped, 1U);
  EXPECT_EQ(s.p50_us, 5.0);
  EXPECT_EQ(s.p99_us, 10.0);
  EXPECT_EQ(s.p999_us, 10.0);
  EXPECT_EQ(s.max_us, 10.0);
  EXPECT_EQ(s.rate_khz, 200.0);
  EXPECT_EQ(s.closest_approach, 0.0);
  EXPECT_EQ(s.deepest_penetration, 1.5);
  EXPECT_EQ(s.cycles_inside, 2U);
  EXPECT_EQ(s.strokes_inside, 1U);
  EXPECT_EQ(s.strokes_breached, 1U);
  EXPECT_EQ(s.crossings, 1U);
  EXPECT_FALSE(s.kept_out());
}

TEST(Summary, ARunThatStaysOutsideTellsItsClosestApproach) {
  const RunSummary s = summarize({.rule = "some", .description = "", .strokes = {plunge(-0.05)}});
  EXPECT_DOUBLE_EQ(s.closest_approach, 0.05);
  EXPECT_EQ(s.deepest_penetration, 0.0);
  EXPECT_TRUE(s.kept_out());
}

TEST(Summary, AClearanceThatIsNotANumberCountsAgainstTheRule) {
  app::Run run{.rule = "some", .description = ""};
  run.strokes = {{{cycle({0, 0, 0}, test::nan)}}};
  EXPECT_EQ(summarize(run).cycles_inside, 1U);
}

TEST(Summary, ARunThatCrossedAnOpenSurfaceCameAsNearAsCanBe) {
  app::Run run{.rule = "some", .description = ""};
  run.strokes = {{std::vector<Cycle>(5, cycle({0, 0, 0}, 0.108))}};
  EXPECT_EQ(summarize(run).closest_approach, 0.108);
  run.crossings = {{0, 1}};
  EXPECT_EQ(summarize(run).closest_approach, 0.0);
  EXPECT_EQ(summarize(run).deepest_penetration, 0.0);
}

TEST(Text, NumbersReadWell) {
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
  EXPECT_EQ(length_text(1.2345), "1.23\u00a0mm");
  EXPECT_EQ(length_text(0.0012345), "1.23\u00a0µm");
  EXPECT_EQ(listed({"a", "b", "c"}), "a, b and c");
}

TEST(Verdict, NamesTheRulesThatFailAndHowDeep) {
  const Mesh mesh(tetrahedron());
  const Json record = record_of(tetrahedron_simulation(mesh));
  EXPECT_CONTAINS(record["headline"].get<std::string>(), "“leaky” let the tool into");
  EXPECT_CONTAINS(record["account"][0].get<std::string>(), "0.0200\u00a0mm deep, in 1 of 1 stroke");
}

TEST(Verdict, SaysIfARuleThatKeptTheToolOutTouchedOrCrossed) {
  app::Run run{.rule = "some", .description = ""};
  const auto outcome = [&](double clearance) {
    run.strokes = {{{cycle({0, 0, 0}, clearance)}}};
    return outcome_of(summarize(run), SurfaceKind::open);
  };
  EXPECT_CONTAINS(outcome(0.0), "touched");
  EXPECT_CONTAINS(outcome(9e-7), "touched");
  EXPECT_CONTAINS(outcome(2e-6), "2.00\u00a0nm");
  run.strokes = {{std::vector<Cycle>(5, cycle({0, 0, 0}, 1.0))}, {{cycle({0, 0, 0}, 1.0)}}};
  run.crossings = {{0, 1}};
  EXPECT_CONTAINS(outcome_of(summarize(run), SurfaceKind::open), "once, in 1 of 2 strokes");
}

TEST(Moments, AreTheDeepestOrElseTheFirstCrossingOrElseTheNearest) {
  const Mesh mesh(tetrahedron());
  Simulation simulation = tetrahedron_simulation(mesh);
  const auto worst_of_the_first_rule = [&] {
    return record_of(simulation)["runs"][1]["worst"]["cycle"].get<int>();
  };
  EXPECT_EQ(worst_of_the_first_rule(), 40);
  const Json telling = record_of(simulation)["moment"];
  EXPECT_EQ(telling["run"], 2) << "the rule that failed, though the tool went deeper without one";
  EXPECT_EQ(telling["cycle"], 40);
  simulation.runs.pop_back();
  EXPECT_EQ(record_of(simulation)["moment"]["run"], 0) << "no rule failed";
  simulation.runs[1].crossings = {{0, 7}};
  EXPECT_EQ(worst_of_the_first_rule(), 7);
  EXPECT_EQ(record_of(simulation)["moment"]["run"], 1);
}

TEST(SimulationRecord, HasEveryCycleAndWhatIsSaidOfIt) {
  const Mesh mesh(tetrahedron());
  const Simulation simulation = tetrahedron_simulation(mesh);
  const Json record = record_of(simulation);
  EXPECT_EQ(fault_of(record), "");
  EXPECT_EQ(record["moment"], (Json{{"run", 2}, {"stroke", 0}, {"cycle", 40}}));
  ASSERT_EQ(record["runs"].size(), 3U);
  for (std::size_t r = 0; r < 3; ++r) {
    const Json& run = record["runs"][r];
    const Json& stroke = run["strokes"][0];
    const std::vector<Cycle>& cycles = simulation.runs[r].strokes[0].cycles;
    ASSERT_EQ(stroke["tip"].size(), cycles.size());
    for (std::size_t c = 0; c < cycles.size(); ++c) {
      EXPECT_NEAR(stroke["tip"][c][2].get<double>(), cycles[c].tip.z(), 0.51e-6);
      EXPECT_NEAR(stroke["clearance_mm"][c].get<double>(), cycles[c].clearance, 0.51e-6);
      EXPECT_TRUE(r > 0 || record["hand"][0][c] == stroke["tip"][c]) << "without a fixture";
    }
    EXPECT_EQ(stroke["outcome"], std::string(cycles.size(), 'f'));
    const RunSummary summary = summarize(simulation.runs[r]);
    EXPECT_EQ(run["kept_out"], summary.kept_out());
    EXPECT_EQ(run["words"], outcome_of(summary, simulation.surface));
    EXPECT_EQ(run["summary"]["cycles_inside"], summary.cycles_inside);
    EXPECT_EQ(run["summary"]["p50_us"], summary.p50_us);
  }
  EXPECT_TRUE(record["benchmark"].is_null());
}

TEST(SimulationRecord, OfAnOpenSurfaceTellsOfNoInside) {
  const Mesh mesh(tetrahedron());
  Simulation simulation = tetrahedron_simulation(mesh);
  simulation.surface = SurfaceKind::open;
  const Json record = record_of(simulation);
  EXPECT_EQ(record["mesh"]["surface"], "open");
  EXPECT_TRUE(record["runs"][0]["summary"]["cycles_inside"].is_null());
  EXPECT_TRUE(record["runs"][0]["summary"]["deepest_mm"].is_null());
}

TEST(SimulationRecord, RefusesWhatItCannotTell) {
  const Mesh mesh(tetrahedron());
  Simulation simulation = tetrahedron_simulation(mesh);
  simulation.runs[1].strokes.clear();
  EXPECT_THROW(record_of(simulation), Error);
  simulation.runs.clear();
  EXPECT_THROW(record_of(simulation), Error);
}

using Hand = std::vector<std::vector<Vec3>>;

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

constexpr HandSettings short_hand{.strokes = 12, .cycles = 200};

TEST(Hand, StrokesGoFromFreeSpaceThroughTheSurfaceAndBack) {
  Audit audit = audit_of(make_cube(10.0));
  const Hand hand = make_hand(audit, short_hand);
  ASSERT_EQ(hand.size(), 12u);
  for (const std::vector<Vec3>& stroke : hand) {
    ASSERT_EQ(stroke.size(), 200u);
    EXPECT_GT(audit.clearance(stroke.front()), 5.0);
    EXPECT_GT(audit.clearance(stroke.back()), 4.0);
    EXPECT_LT(audit.clearance(stroke[60]), 0.0);
  }
}

TEST(Hand, TheSameSeedMovesAlike) {
  Audit audit = audit_of(make_cube(10.0));
  HandSettings other_seed = short_hand;
  other_seed.seed = 2;
  const Hand hand = make_hand(audit, short_hand);
  EXPECT_EQ(hand, make_hand(audit, short_hand));
  EXPECT_NE(hand, make_hand(audit, other_seed));
}

TEST(Hand, AFlatSheetIsPushedThroughFromItsFreeSide) {
  Audit audit = audit_of(make_flat_plate(5.0, 1));
  for (const std::vector<Vec3>& stroke : make_hand(audit, short_hand)) {
    EXPECT_GT(stroke.front().z(), 5.0);
    EXPECT_LT(stroke[60].z(), 0.0);
  }
}

TEST(Hand, ASingleTriangleIsEnough) {
  Audit audit = audit_of({{{0, 0, 0}, {100, 0, 0}, {0, 100, 0}}, {{0, 1, 2}}});
  for (const std::vector<Vec3>& stroke : make_hand(audit, short_hand)) {
    EXPECT_GT(stroke.front().z(), 5.0);
    EXPECT_LT(stroke[60].z(), 0.0);
    for (const Vec3& goal : stroke) ASSERT_TRUE(goal.allFinite());
  }
}

TEST(Hand, AMeshThatKeepsTheToolInsideIsPushedFromInside) {
  Audit audit = audit_of(make_concave_sphere(5.0));  // of radius 50, the inside is free
  for (const std::vector<Vec3>& stroke : make_hand(audit, short_hand)) {
    EXPECT_LT(stroke.front().norm(), 46.0);
    EXPECT_GT(stroke[60].norm(), 49.5);
  }
}

TEST(Hand, PlacesThatFaceOutwardsArePreferred) {
  // A shell: half of its area is the wall of a cavity that has room enough.
  Surface cavity = make_concave_sphere(5.0);
  for (Vec3& vertex : cavity.vertices) vertex *= 0.8;
  Audit audit = audit_of(joined(make_sphere(5.0), cavity));
  for (const std::vector<Vec3>& stroke : make_hand(audit, short_hand)) {
    EXPECT_GT(stroke.front().norm(), 50.0);
  }
}

TEST(Hand, WithoutRoomAnywhereTheErrorNamesTheRemedy) {
  Audit audit = audit_of(inside_out(make_thin_plates(10.0)));  // free are the plates: 1 mm
  const std::string message = error_of([&] { make_hand(audit, short_hand); });
  for (const char* word : {"no free place", "room for 8 mm", "flip", "keepout inspect"}) {
    EXPECT_CONTAINS(message, word);
  }
}

}  // namespace
}  // namespace keepout::app
