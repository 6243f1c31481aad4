// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "number_text.h"
#include "report/bars.h"
#include "report/label_places.h"
#include "report/mark.h"
#include "report/plot.h"
#include "report/spans.h"
#include "report_scene.h"

namespace keepout::app {
namespace {

TEST(LabelPlaces, LabelsWithRoomStayWhereTheyWantToBe) {
  EXPECT_EQ(label_places({80.0, 20.0, 50.0}, 17.0, 0.0, 100.0),
            (std::vector<double>{80.0, 20.0, 50.0}));
  EXPECT_TRUE(label_places({}, 17.0, 0.0, 100.0).empty());
}

TEST(LabelPlaces, LabelsThatCollideMoveApartEvenlyInTheirOrder) {
  EXPECT_EQ(label_places({51.0, 49.0}, 10.0, 0.0, 100.0), (std::vector<double>{55.0, 45.0}));
  EXPECT_EQ(label_places({50.0, 50.0, 50.0}, 10.0, 0.0, 100.0),
            (std::vector<double>{40.0, 50.0, 60.0}));
}

TEST(LabelPlaces, NothingLeavesTheRange) {
  EXPECT_EQ(label_places({-5.0, 0.0, 3.0}, 10.0, 0.0, 100.0),
            (std::vector<double>{0.0, 10.0, 20.0}));
  EXPECT_EQ(label_places({99.0, 130.0}, 10.0, 0.0, 100.0), (std::vector<double>{90.0, 100.0}));
  EXPECT_EQ(label_places({5.0, 5.0, 5.0}, 100.0, 0.0, 10.0), (std::vector<double>{0.0, 5.0, 10.0}));
}

TEST(Marks, TwentySeriesLookDifferent) {
  std::set<std::pair<Mark, std::string>> looks;
  for (std::size_t i = 0; i < 20; ++i) looks.insert({mark_of(i), series_class(i)});
  EXPECT_EQ(looks.size(), 20U);
}

TEST(Plot, TicksAreShort) {
  EXPECT_EQ(tick_text(0.0), "0");
  EXPECT_EQ(tick_text(0.0001), "0.0001");
  EXPECT_EQ(tick_text(1e-6), "10⁻⁶");
  EXPECT_EQ(tick_text(2e-15), "2·10⁻¹⁵");
  EXPECT_EQ(tick_text(5000.0), "5000");
  EXPECT_EQ(tick_text(50000.0), "50k");
  EXPECT_EQ(tick_text(1e7), "10M");
}

Plot two_lines() {
  Plot plot;
  plot.x = {.label = "x", .low = 0.0, .high = 10.0};
  plot.y = {.label = "y", .low = 0.0, .high = 10.0};
  plot.names = Plot::Names::at_line_ends;
  plot.series = {{"one", "series-0", {{0.0, 1.0}, {10.0, 5.0}}, mark_of(0)},
                 {"<two>", "series-1", {{0.0, 1.0}, {5.0, 5.0}}, mark_of(1)},
                 {"none", "series-2", {}, mark_of(2)}};
  return plot;
}

TEST(Plot, NamesAtLineEndsKeepClearOfEachOther) {
  const std::string svg = to_svg(two_lines());
  EXPECT_EQ(fault_in_xml(svg), "");
  const auto height_of = [&](const std::string& words) {
    const std::size_t start = svg.rfind("<text", svg.find(">" + words + "<"));
    return std::stod(svg.substr(svg.find("y=\"", start) + 3));
  };
  EXPECT_NEAR(std::abs(height_of("one") - height_of("&lt;two&gt;")), 17.0, 0.11);
  EXPECT_EQ(svg.find(">none<"), std::string::npos);  // it has no end
  EXPECT_EQ(svg.find("class=\"legend"), std::string::npos);
}

TEST(Plot, MarksNeedNoLine) {
  Plot plot = two_lines();
  for (Series& series : plot.series) series.join = Series::Join::none;
  plot.names = Plot::Names::above;
  const std::string svg = to_svg(plot);
  EXPECT_EQ(fault_in_xml(svg), "");
  EXPECT_EQ(svg.find("class=\"line"), std::string::npos);
  EXPECT_NE(svg.find("class=\"mark series-1\""), std::string::npos);
}

TEST(Bars, AreAsLongAsTheirValueOrAsLongAsEachOther) {
  Bars chart{
      .title = "<bars>",
      .description = "a & b",
      .parts = {{"first", "series-0"}, {"second", "series-1"}},
      .bars = {{"<long>", "4 s", {3.0, 1.0}}, {"short", "1 s", {0.5, 0.5}}, {"none", "0", {}}}};
  const std::string values = to_svg(chart);
  EXPECT_EQ(fault_in_xml(values), "");
  EXPECT_NE(values.find("width=\"402.0\""), std::string::npos) << values;  // 3 of 4, of 536
  EXPECT_NE(values.find("width=\"67.0\""), std::string::npos);
  EXPECT_EQ(values.find("class=\"share\""), std::string::npos);
  chart.length = Bars::Length::of_share;
  const std::string shares = to_svg(chart);
  EXPECT_EQ(fault_in_xml(shares), "");
  EXPECT_NE(shares.find("width=\"268.0\""), std::string::npos);
  EXPECT_NE(shares.find(">75 %<"), std::string::npos);
}

TEST(Spans, WhatIsNotAboveZeroHasALabelAndNoMark) {
  Spans chart{.description = "d", .axis = "time", .spans = {}};
  chart.spans.push_back({"<some>", "2", "series-0", Mark::disc, 2.0, 20.0, 1.0});
  chart.spans.push_back({"zero", "0", "series-1", Mark::disc, 0.0});
  const std::string svg = to_svg(chart);
  EXPECT_EQ(fault_in_xml(svg), "");
  EXPECT_NE(svg.find("class=\"mark series-0\""), std::string::npos);
  EXPECT_NE(svg.find("class=\"mark open series-0\""), std::string::npos);
  EXPECT_NE(svg.find(">zero<"), std::string::npos);
  EXPECT_EQ(svg.find("mark series-1"), std::string::npos);
  chart.spans.clear();
  EXPECT_EQ(fault_in_xml(to_svg(chart)), "");
}

TEST(Text, TimesAndRatiosReadWell) {
  EXPECT_EQ(time_text(0.0512), "0.0512\u00a0µs");
  EXPECT_EQ(time_text(1264.0), "1264\u00a0µs");
  EXPECT_EQ(time_text(54000.0), "54.0\u00a0ms");
  EXPECT_EQ(ratio_text(54.1), "54");
  EXPECT_EQ(ratio_text(3.24), "3.2");
}

}  // namespace
}  // namespace keepout::app
