// SPDX-License-Identifier: BSD-3-Clause
#include "report/plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "report/figures.h"
#include "report/views.h"
#include "report_scene.h"

namespace keepout::app {
namespace {

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

}  // namespace
}  // namespace keepout::app
