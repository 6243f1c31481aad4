// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/error.h"
#include "number_text.h"
#include "report/figures.h"
#include "report/html_report.h"
#include "report/plot.h"
#include "report/png.h"
#include "report/raster.h"
#include "report/shading.h"
#include "report/text.h"
#include "report/tube.h"
#include "report/verdict.h"
#include "report/views.h"
#include "simulation_record.h"
#include "small_surfaces.h"
#include "temporary_folder.h"

namespace keepout::app {
namespace {

/// What is wrong with the nesting, quoting or escaping of an XML text; empty when nothing is.
/// `unclosed`: elements that have no end tag. Knows as much of XML as our own pages use.
std::string fault_in_xml(std::string_view text, std::vector<std::string_view> unclosed = {}) {
  std::vector<std::string> open;
  std::size_t at = 0;
  const auto fault = [&](const std::string& what) {
    return what + " near: " + std::string(text.substr(at, 80));
  };
  while (at < text.size()) {
    if (text[at] == '&') {
      const std::size_t end = text.find(';', at);
      if (end == std::string_view::npos || end - at > 7) return fault("bare ampersand");
    }
    if (text[at] == '>') return fault("bare >");
    if (text[at] != '<') {
      ++at;
      continue;
    }
    // The end of the tag is the first '>' outside of quotation marks.
    std::size_t end = at + 1;
    for (bool quoted = false; end < text.size() && (quoted || text[end] != '>'); ++end) {
      if (text[end] == '"') quoted = !quoted;
      if (text[end] == '<') return fault("< within a tag");
    }
    if (end >= text.size()) return fault("tag without an end");
    const std::string_view tag = text.substr(at + 1, end - at - 1);
    const bool closing = tag.starts_with('/');
    const std::string_view rest = closing ? tag.substr(1) : tag;
    const std::string name(rest.substr(0, std::min(rest.find_first_of(" /"), rest.size())));
    if (closing) {
      if (open.empty() || open.back() != name) return fault("wrong end tag");
      open.pop_back();
    } else if (!tag.ends_with('/') &&
               std::find(unclosed.begin(), unclosed.end(), name) == unclosed.end()) {
      open.push_back(name);
    }
    at = end + 1;
  }
  return open.empty() ? "" : "not closed: " + open.back();
}

/// The same for one of our HTML pages; the style sheet is no markup and is passed over.
std::string fault_in_html(std::string page) {
  const std::string opening = "<!DOCTYPE html>\n";
  if (!page.starts_with(opening)) return "no doctype";
  page.erase(0, opening.size());
  const std::size_t style = page.find("<style>") + 7;
  page.erase(style, page.find("</style>") - style);
  return fault_in_xml(page, {"meta", "br"});
}

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
  run.strokes = {{{cycle({0, 0, 0}, std::numeric_limits<double>::quiet_NaN())}}};
  EXPECT_EQ(summarize(run).cycles_inside, 1U);
}

TEST(Summary, PastAnOpenSurfaceIsAfterAnOddNumberOfCrossings) {
  app::Run run{.rule = "some", .description = ""};
  run.strokes = {{std::vector<Cycle>(5, cycle({0, 0, 0}, 1.0))}};
  run.crossings = {{0, 1}, {0, 3}};
  EXPECT_EQ(trespass(run, 0, SurfaceKind::open),
            (std::vector<bool>{false, true, true, false, false}));
  EXPECT_EQ(summarize(run).cycles_inside, 0U);
  EXPECT_EQ(summarize(run).strokes_breached, 1U);
}

TEST(Summary, ARunThatCrossedAnOpenSurfaceCameAsNearAsCanBe) {
  app::Run run{.rule = "some", .description = ""};
  run.strokes = {{std::vector<Cycle>(5, cycle({0, 0, 0}, 0.108))}};
  EXPECT_EQ(summarize(run).closest_approach, 0.108);
  run.crossings = {{0, 1}};
  EXPECT_EQ(summarize(run).closest_approach, 0.0);
  EXPECT_EQ(summarize(run).deepest_penetration, 0.0);
}

TEST(Png, DecodesBackToTheSamePixels) {
  Image image({7, 5});
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    image.rgba[i] = static_cast<std::uint8_t>(i * 37 % 251);
  }
  const std::vector<std::uint8_t> file = to_png(image);

  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&header, file.data(), file.size()), 0);
  EXPECT_EQ(header.width, 7U);
  EXPECT_EQ(header.height, 5U);
  header.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(header));
  ASSERT_NE(png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr), 0);
  EXPECT_EQ(pixels, image.rgba);
}

TEST(Png, Base64IsThatOfTheStandard) {
  const auto encode = [](const std::string& text) {
    return to_base64(std::vector<std::uint8_t>(text.begin(), text.end()));
  };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
}

/// Looks down the z axis; a pixel is a millimetre, the middle of the picture is the origin.
Camera from_above() { return look_from(Vec3::UnitZ(), Vec3::UnitY(), Vec3::Zero(), 20.0); }
constexpr ImageSize small = {20, 20};

Surface square(double z, double half) {
  return {{{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}},
          {{0, 1, 2}, {0, 2, 3}}};
}

TEST(Raster, ATriangleCoversItsPixelsAndNoOthers) {
  const Mesh mesh({{{-6, -6, 0}, {6, -6, 0}, {-6, 6, 0}}, {{0, 1, 2}}});
  const Image image = shade(rasterize(mesh, from_above(), small, Interior::hollow));
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 20; ++column) {
      const double x = column + 0.5 - 10.0, y = 10.0 - row - 0.5;
      const double within = std::min({x + 6.0, y + 6.0, -(x + y) / std::sqrt(2.0)});
      if (std::abs(within) < 0.75) continue;  // the edge may be blended
      EXPECT_EQ(image.pixel(column, row)[3], within > 0.0 ? 255 : 0) << x << ", " << y;
    }
  }
}

TEST(Raster, TheNearerSurfaceShowsWhateverTheOrder) {
  for (const auto& [first, second] : {std::pair{1.0, 4.0}, {4.0, 1.0}}) {
    const Mesh mesh(together(square(first, 8), square(second, 8)));
    const Samples samples = rasterize(mesh, from_above(), small, Interior::hollow);
    EXPECT_FLOAT_EQ(samples.depth[samples.at(20, 20)], 4.0F * Samples::per_pixel);
  }
}

TEST(Raster, TheBackOfATriangleShowsAsTheInside) {
  const Mesh mesh(flipped(square(0, 8)));
  const Samples samples = rasterize(mesh, from_above(), small, Interior::hollow);
  EXPECT_EQ(samples.shown[samples.at(20, 20)], Shown::inside);
}

TEST(Raster, ACutThroughASolidShowsAFlatSectionAtTheCut) {
  Surface surface = tetrahedron();
  for (Vec3& v : surface.vertices) v = 8.0 * v - Vec3(2, 2, 2);  // legs from -2 to 6
  const Mesh mesh(std::move(surface));
  Camera camera = from_above();
  camera.cut = Cut{{Vec3(-5, 0, 1), Vec3(5, 0, 1)}, 0, Vec3::UnitY()};
  const Samples samples = rasterize(mesh, camera, small, Interior::solid);
  const std::size_t in_solid = samples.at(20, 20), beside = samples.at(25, 20);
  EXPECT_EQ(samples.shown[in_solid], Shown::section);
  EXPECT_FLOAT_EQ(samples.depth[in_solid], 2.0F);
  EXPECT_EQ(samples.shown[beside], Shown::outside);  // the slanted face, below the cut
}

TEST(Tube, InFrontIsSeenBehindIsNotAndInsideIsSeenThroughTheSurface) {
  const Mesh mesh(square(0, 8));
  const Samples samples = rasterize(mesh, from_above(), small, Interior::hollow);
  const auto drawn = [&](double z, Tube::Sight sight) {
    const Tube tube{
        .points = {{-5, 0, z}, {5, 0, z}}, .radius = 2.0, .color = alarm_color, .sight = sight};
    return draw_tubes(samples, from_above(), std::span(&tube, 1));
  };
  const Image front = drawn(3, Tube::Sight::hidden_by_surface);
  EXPECT_EQ(front.pixel(10, 10)[3], 255);
  EXPECT_GT(front.pixel(10, 10)[0], 4 * front.pixel(10, 10)[1]);  // red
  EXPECT_EQ(front.pixel(10, 4)[3], 0);                            // beside it
  EXPECT_EQ(drawn(-3, Tube::Sight::hidden_by_surface).pixel(10, 10)[3], 0);
  const Image inside = drawn(-3, Tube::Sight::through_surface);
  EXPECT_EQ(inside.pixel(10, 10)[3], 255);
  EXPECT_GT(inside.pixel(10, 10)[0], 4 * inside.pixel(10, 10)[1]);
}

TEST(Views, TheTellingMomentIsTheDeepestOfARuleNotOfTheFreeHand) {
  const Mesh mesh(tetrahedron());
  Simulation simulation = tetrahedron_simulation(mesh);
  EXPECT_EQ(telling_moment(simulation).run, 2U);
  EXPECT_EQ(telling_moment(simulation).cycle, 40U);
  simulation.runs.pop_back();
  EXPECT_EQ(telling_moment(simulation).run, 0U);
}

/// A flat surface with its free side up, and a tip that slides over it for 40 mm.
Surface flat_ground() { return square(0, 50); }

Stroke slide(double height) {
  Stroke stroke;
  for (int i = 0; i <= 200; ++i) {
    const double raised = i < 50 ? 0.16 * (50 - i) : 0.0;
    stroke.cycles.push_back(cycle({0.2 * i - 20.0, 0.0, raised + height}, raised + height));
  }
  return stroke;
}

/// `depth` is that of the rule; the other rule touches, from the middle of the stroke to its end.
Simulation slides(const Mesh& mesh, double depth, SurfaceKind surface = SurfaceKind::closed) {
  Simulation simulation{.mesh_name = "ground", .mesh = &mesh, .surface = surface};
  simulation.runs.push_back({.rule = no_rule, .description = "", .strokes = {slide(-4.0)}});
  simulation.runs.push_back({.rule = "rule", .description = "", .strokes = {slide(-depth)}});
  simulation.runs.push_back({.rule = "other", .description = "", .strokes = {slide(0.5)}});
  simulation.runs.back().strokes[0].cycles.back() = cycle({20, 0, 0}, 0.0);
  return simulation;
}

constexpr ImageSize close = {200, 150};

TEST(CloseUps, ShowTheWholeStrokeAndEveryMarkedMoment) {
  const Mesh mesh(flat_ground());
  const Simulation simulation = slides(mesh, 0.0);
  const std::vector<CloseUp> views = close_ups(simulation, telling_moment(simulation), close);
  ASSERT_EQ(views.size(), 3U);
  for (const app::Run& run : simulation.runs) {
    for (const Cycle& c : run.strokes[0].cycles) {
      const PicturePoint p = project(views[0].camera, close, c.tip);
      EXPECT_TRUE(p.x > 5.0 && p.x < 195.0 && p.y > 5.0 && p.y < 135.0) << p.x << ", " << p.y;
    }
  }
  EXPECT_EQ(views[2].worst, 200U);
}

TEST(CloseUps, OfAnOpenSurfaceWithoutAMarginShowMillimetres) {
  const Mesh mesh(flat_ground());
  Simulation simulation = slides(mesh, 0.0, SurfaceKind::open);
  for (app::Run& run : simulation.runs) {
    for (Cycle& c : run.strokes[0].cycles) c.clearance = std::abs(c.clearance);
  }
  simulation.runs[1].crossings = {{0, 100}};
  const Moment moment = telling_moment(simulation);
  EXPECT_EQ(moment.run, 1U);
  EXPECT_EQ(moment.cycle, 100U);
  const std::vector<CloseUp> views = close_ups(simulation, moment, close);
  EXPECT_GT(views[1].camera.view_height, 5.0);
  EXPECT_TRUE(shows(views[1].camera, close, simulation.runs[1].strokes[0].cycles[100].tip));
}

TEST(CloseUps, OfASmallDepthShowItLargeAndMarkWhatIsInSight) {
  const Mesh mesh(flat_ground());
  const Simulation simulation = slides(mesh, 0.1);
  const Moment moment = telling_moment(simulation);
  const std::vector<CloseUp> views = close_ups(simulation, moment, close);
  const double height = views[1].camera.view_height;
  EXPECT_LE(height, 14.0 * 0.1 + 1e-9);
  const auto marked = [&](std::size_t run) {
    return simulation.runs[run].strokes[0].cycles[views[run].worst];
  };
  EXPECT_TRUE(shows(views[1].camera, close, marked(1).tip));
  EXPECT_TRUE(shows(views[2].camera, close, marked(2).tip));
  EXPECT_EQ(marked(2).clearance, 0.5);
  EXPECT_EQ(marked(0).clearance, -4.0);  // out of sight, and told for all that
  EXPECT_NE(close_up_picture(simulation, moment, views[0], 0).find("↓ 4.00\u00a0mm deep"),
            std::string::npos);
}

TEST(Plots, AreEnlargedAroundTheSurfaceEvenWhereRulesOnlyTouch) {
  const Mesh mesh(flat_ground());
  const Simulation simulation = slides(mesh, 0.0);
  const std::string all = clearance_plot(simulation, 0), near = near_surface_plot(simulation, 0);
  EXPECT_NE(all.find(">5</text>"), std::string::npos) << all;
  EXPECT_EQ(near.find(">5</text>"), std::string::npos);
  EXPECT_NE(near.find(">0.2</text>"), std::string::npos) << near;
}

/// The number that follows a text, from the place where a plot writes some words.
double written_at(const std::string& svg, const std::string& words, const std::string& attribute) {
  const std::size_t start = svg.rfind("<text", svg.find(">" + words + "<"));
  return std::stod(svg.substr(svg.find(attribute + "=\"", start) + attribute.size() + 2));
}

TEST(Plot, ALabelOfABandKeepsClearOfTheCurves) {
  Plot plot;
  plot.x = {.label = "x", .low = 0.0, .high = 100.0};
  plot.y = {.label = "y", .low = -10.0, .high = 10.0};
  plot.bands = {{-10.0, 0.0, "inside"}};
  plot.series = {{"one", "rule-0", {{0.0, -9.7}, {50.0, -9.7}, {50.0, -5.0}, {100.0, -5.0}}}};
  const std::string svg = to_svg(plot);
  EXPECT_GT(written_at(svg, "inside", "x"), 0.5 * (66.0 + 534.0));
  EXPECT_GT(svg.find(">inside<"), svg.find("class=\"line"));  // written over what it must cover
  plot.series[0].points = {{0.0, 5.0}, {100.0, 5.0}};
  EXPECT_EQ(written_at(to_svg(plot), "inside", "x"), 74.0);
}

TEST(Plot, ThinningKeepsEveryPeak) {
  std::vector<PlotPoint> points;
  for (int i = 0; i < 24000; ++i) points.push_back({i / 24000.0, std::sin(0.01 * i)});
  points[12345].y = 50.0;
  points[777].y = -60.0;
  const std::vector<PlotPoint> few = thin_out(points, 0.0, 1.0, 100);
  EXPECT_LE(few.size(), 404U);
  const auto [low, high] = std::minmax_element(
      few.begin(), few.end(), [](const PlotPoint& a, const PlotPoint& b) { return a.y < b.y; });
  EXPECT_EQ(low->y, -60.0);
  EXPECT_EQ(high->y, 50.0);
  EXPECT_EQ(few.front().x, points.front().x);
  EXPECT_EQ(few.back().x, points.back().x);
  EXPECT_TRUE(std::is_sorted(few.begin(), few.end(),
                             [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; }));
}

TEST(Plot, TicksAreRoundNumbersWithinTheRange) {
  EXPECT_EQ(linear_ticks(-1.0, 4.1, 5), (std::vector<double>{0.0, 2.0, 4.0}));
  EXPECT_EQ(logarithmic_ticks(0.5, 2000.0), (std::vector<double>{1.0, 10.0, 100.0, 1000.0}));
}

TEST(Plot, IsWellFormedAndPutsTheExtremesOnTheFrame) {
  Plot plot;
  plot.description = "a < b & \"c\"";
  plot.x = {.label = "x <mm>", .low = 0.0, .high = 10.0};
  plot.y = {.label = "y & z", .scale = Axis::Scale::logarithmic, .low = 1.0, .high = 100.0};
  plot.series = {{"<one>", "rule-0", {{0.0, 1.0}, {5.0, -3.0}, {10.0, 100.0}}}};
  plot.markers = {{Marker::Across::at_x, 5.0, "<here>"}};
  const std::string svg = to_svg(plot);
  EXPECT_EQ(fault_in_xml(svg), "");
  // From the lower left to the upper right of the frame, without the point that has no logarithm.
  EXPECT_NE(svg.find("d=\"M66.0,348.0L534.0,28.0\""), std::string::npos) << svg;
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
  const Simulation simulation = tetrahedron_simulation(mesh);
  std::vector<RunSummary> summaries;
  for (const app::Run& run : simulation.runs) summaries.push_back(summarize(run));
  EXPECT_EQ(headline(simulation, summaries),
            "Rule “leaky” let the tool into the anatomy; “safe” kept it out.");
  const std::string text = account(simulation, summaries);
  EXPECT_NE(text.find("Under “leaky” it went up to 0.0200\u00a0mm deep, in 1 of 1 stroke."),
            std::string::npos)
      << text;
}

TEST(Verdict, SaysWhetherARuleThatKeptTheToolOutTouched) {
  const auto outcome = [](double clearance) {
    app::Run run{.rule = "some", .description = ""};
    run.strokes = {{{cycle({0, 0, 0}, clearance)}}};
    return outcome_of(summarize(run), SurfaceKind::open);
  };
  EXPECT_EQ(outcome(0.0), "stayed outside but touched the surface");
  EXPECT_EQ(outcome(9e-7), "stayed outside but touched the surface");
  EXPECT_EQ(outcome(2e-6), "stayed outside, never nearer than 2.00\u00a0nm");
}

TEST(Verdict, CountsCrossingsOfAnOpenSurfaceInWords) {
  app::Run run{.rule = "some", .description = ""};
  run.strokes = {{std::vector<Cycle>(5, cycle({0, 0, 0}, 1.0))}, {{cycle({0, 0, 0}, 1.0)}}};
  run.crossings = {{0, 1}};
  EXPECT_EQ(outcome_of(summarize(run), SurfaceKind::open),
            "went through the surface once, in 1 of 2 strokes");
}

std::string page_of(const Simulation& simulation) {
  std::ostringstream page;
  print_report(page, simulation);
  return page.str();
}

TEST(Report, TellsHowTheCheckDecides) {
  const Mesh mesh(flat_ground());
  const std::string closed = page_of(slides(mesh, 0.0));
  EXPECT_NE(closed.find("a ray from the tip passes"), std::string::npos);
  EXPECT_NE(closed.find("brute force"), std::string::npos);
  EXPECT_NE(closed.find("after which, or during which, the tip was on the other side"),
            std::string::npos);
  const std::string open = page_of(slides(mesh, 0.0, SurfaceKind::open));
  EXPECT_EQ(open.find("a ray from the tip passes"), std::string::npos);
  EXPECT_NE(open.find("pseudonormal"), std::string::npos);
}

TEST(Report, ALongSettingGetsTheWholeWidth) {
  const Mesh mesh(flat_ground());
  Simulation simulation = slides(mesh, 0.0);
  simulation.settings = {{"seed", "1"}, {"command", "keepout simulate " + std::string(80, 'x')}};
  const std::string page = page_of(simulation);
  EXPECT_NE(page.find("<dt>seed</dt><dd>1</dd>"), std::string::npos);
  EXPECT_NE(page.find("<dt class=\"wide\">command</dt><dd class=\"wide\">"), std::string::npos);
}

TEST(Report, IsOneWellFormedPageThatNeedsNothingElse) {
  const Mesh mesh(tetrahedron());
  const Simulation simulation = tetrahedron_simulation(mesh);
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("report.html", "an older report");
  write_report(file, simulation);

  std::ostringstream contents;
  contents << std::ifstream(file).rdbuf();
  const std::string page = contents.str();
  EXPECT_EQ(fault_in_html(page), "");
  for (const char* reference : {"http:", "https:", "src=", "url(", "@import", "<script", "<link"}) {
    EXPECT_EQ(page.find(reference), std::string::npos) << reference;
  }
  for (std::size_t at = page.find("href=\""); at != std::string::npos;
       at = page.find("href=\"", at + 1)) {
    const std::string target = page.substr(at + 6, 22);
    EXPECT_TRUE(target.starts_with('#') || target == "data:image/png;base64,") << target;
  }
  EXPECT_NE(page.find("&lt;tetra&gt; &amp; &quot;friends&quot;"), std::string::npos);
  EXPECT_EQ(page.find("<tetra>"), std::string::npos);
  EXPECT_NE(page.find("&lt;1&gt;"), std::string::npos);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(Report, RefusesWhatItCannotShow) {
  const Mesh mesh(tetrahedron());
  Simulation simulation = tetrahedron_simulation(mesh);
  const TemporaryFolder folder;
  EXPECT_THROW(write_report(folder.path() / "no" / "such" / "folder.html", simulation), Error);
  simulation.runs[1].strokes.clear();
  EXPECT_THROW(write_report(folder.path() / "report.html", simulation), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace keepout::app
