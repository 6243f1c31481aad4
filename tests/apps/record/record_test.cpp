// SPDX-License-Identifier: BSD-3-Clause
#include "record/record.h"

#include <sstream>

#include "apps/page/unpacked_page.h"
#include "messages.h"
#include "record/drawn_mesh.h"
#include "record/flat_rows.h"
#include "record/plain_page.h"
#include "trials.h"

namespace keepout::app {
namespace {

/// Returns a record with HTML in its names, as a hostile file may have it.
Json some_record() {
  Json record = new_record({.kind = "bench",
                            .command = "keepout bench --mesh '<b>&\"'",
                            .subject = "<i>All</i> & more",
                            .headline = "A < B",
                            .account = {"First.", "Second."},
                            .settings = {{"seed", "<1>"}}});
  record["rows"] = {{{"mesh", "<lost> \"them\""}, {"triangles", 51978}, {"us", {{"p50", 1.25}}}},
                    {{"mesh", "b"}, {"triangles", nullptr}, {"remark", "slow"}}};
  record["series"] = {1.0, 2.0, 3.0};
  return record;
}

TEST(Record, IsReadBackAsItWasWritten) {
  const Json record = some_record();
  std::ostringstream text;
  print_json(text, record);
  EXPECT_EQ(Json::parse(text.str()), record);
  EXPECT_EQ(fault_of(record), "");
  // Each row is one line, so that diff can compare two records.
  EXPECT_CONTAINS(text.str(), "\n{\"mesh\":\"b\"");
  EXPECT_CONTAINS(text.str(), "\n\"series\": [1.0,2.0,3.0]");
}

TEST(Record, BytesThatAreNoTextAndNumbersThatAreNoneLeaveItWhole) {
  Json record = some_record();
  record["name"] = "skull\xff.stl";
  record["none"] = test::nan;
  std::ostringstream text;
  print_json(text, record);
  const Json read = Json::parse(text.str());
  EXPECT_TRUE(read["none"].is_null());
  EXPECT_EQ(read["name"], "skull\uFFFD.stl");
}

TEST(Record, WhatLacksAPartOfTheHeadIsNone) {
  const Json head = new_record({});
  for (const auto& member : head.items()) {
    Json record = some_record();
    record.erase(member.key());
    EXPECT_NE(fault_of(record), "") << member.key();
  }
  Json later = some_record();
  later["format"] = 99;
  EXPECT_CONTAINS(fault_of(later), "format 99");
  Json other = some_record();
  other["keepout_record"] = "lunch";
  EXPECT_NE(fault_of(other), "");
  Json torn = some_record();
  torn["account"] = "one";
  EXPECT_NE(fault_of(torn), "");
  torn["account"] = {1};
  EXPECT_NE(fault_of(torn), "");
  EXPECT_NE(fault_of(Json::array({1, 2})), "");
}

TEST(PlainPage, ShowsWordsAndRowsAsText) {
  std::ostringstream out;
  print_plain_page(out, some_record());
  const std::string page = out.str();
  for (const char* words :
       {"<h1>A &lt; B</h1>", "<p>&lt;i&gt;All&lt;/i&gt; &amp; more</p>", "<p>Second.</p>",
        "keepout bench --mesh '&lt;b&gt;&amp;&quot;'", "<td>seed</td><td>&lt;1&gt;</td>",
        "<th>mesh</th><th>triangles</th><th>remark</th><th>us_p50</th>",
        "<td>&lt;lost&gt; &quot;them&quot;</td><td>51,978</td><td>-</td><td>1.25</td>",
        "<td>b</td><td>-</td><td>slow</td><td>-</td>"}) {
    EXPECT_CONTAINS(page, words) << words;
  }
  EXPECT_LACKS(page, "<lost>");
  for (const char* reference : {"http", "src=", "<script", "<link"}) {
    EXPECT_LACKS(page, reference) << reference;
  }
}

TEST(PlainPage, ShowsExperimentsInTablesAndInPicturesThatDoNothing) {
  Json record = new_record({.kind = "experiments", .headline = "Redone"});
  EXPECT_EQ(fault_of(record), "");
  const Json first = Json::parse(R"({
    "name": "e3", "title": "E3 <Path>", "headline": "Smoother.",
    "claims": [{"about": "depth", "paper": "0.39 mm", "note": "a < b"}],
    "tables": [{"title": "By mode", "columns": ["mode", "p"], "rows": [["none", "< 0.001"]],
                "note": "Less is better."}],
    "figures": [{"name": "box", "title": "A \"box\"", "caption": "Each point.",
                 "svg": "<svg><script>harm()</script></svg>"}]})");
  Json second = first;
  second["title"] = "E4";
  record["experiments"] = {first, second};
  std::ostringstream out;
  print_plain_page(out, record);
  const std::string page = out.str();
  for (const char* words :
       {"<h2>Compared with Li et al. (2020)</h2>",
        "<th>experiment</th><th>about</th><th>paper</th>",
        "<td>E3 &lt;Path&gt;</td><td>depth</td><td>0.39 mm</td><td>a &lt; b</td>",
        "<td>E4</td><td>depth</td>", "<h2>E3 &lt;Path&gt;</h2>\n<p>Smoother.</p>",
        "<tr><th>mode</th><th>p</th></tr>", "<tr><td>none</td><td>&lt; 0.001</td></tr>",
        "<p>Less is better.</p>",
        "<img alt=\"A &quot;box&quot;\" "
        "src=\"data:image/svg+xml;base64,PHN2Zz48c2NyaXB0Pmhhcm0oKTwvc2"
        "NyaXB0Pjwvc3ZnPg==\">",
        "</b> Each point.</figcaption>"}) {
    EXPECT_CONTAINS(page, words) << words;
  }
  EXPECT_LACKS(page, "<script");
  EXPECT_EQ(page.find("<h2>"), page.find("<h2>Compared with Li et al. (2020)"));
  EXPECT_LACKS(page, "<h2>experiments");
}

TEST(FlatRows, AsCsvKeepEveryDigitAndQuoteWhatMustBe) {
  std::ostringstream out;
  const Json rows = {{{"a", 0.1}, {"b", nullptr}, {"z", 1e-17}, {"e", {1, 2}}},
                     {{"a", 3}, {"b", {{"c", true}, {"d", nullptr}}}, {"f", "x, \"y\""}}};
  print_csv(out, flat(rows));
  EXPECT_EQ(out.str(), "a,b_c,b_d,f,z\n0.1,,,,1e-17\n3,true,,\"x, \"\"y\"\"\",\n");
}

Mesh fine_sphere() { return Mesh(make_sphere(1.5)); }

TEST(DrawnMesh, HasEveryBitOfAMeshOfModestSize) {
  const Mesh mesh = fine_sphere();
  const Json json = drawn_mesh("<ball>", mesh);
  EXPECT_EQ(json["name"], "<ball>");
  EXPECT_EQ(json["triangles"], mesh.triangle_count());
  const Json& drawn = json["drawn"];
  EXPECT_EQ(drawn["triangles"], mesh.triangle_count());
  const auto bytes = test::gunzipped(test::from_base64(drawn["packed"].get<std::string>()));
  EXPECT_TRUE(test::same_bits(test::unpacked(drawn["coordinates"].get<std::string>(), bytes,
                                             mesh.vertex_count(), mesh.triangle_count()),
                              mesh));
}

TEST(DrawnMesh, ACoarserOneIsNearTheSurfaceAndWholeWhereOneLooksClosely) {
  const Mesh mesh = fine_sphere();
  const Box top{{-60, -60, 45}, {60, 60, 60}};
  constexpr std::size_t most = 2000;
  const Surface coarse = coarsened(mesh, most, std::nullopt);
  EXPECT_LE(coarse.triangles.size(), most);
  EXPECT_GT(coarse.triangles.size(), most / 8);
  for (const Vec3& vertex : coarse.vertices) EXPECT_NEAR(vertex.norm(), 50.0, 1e-3);

  // All triangles of the mesh with all corners in the box are included, whatever their number.
  const Surface close = coarsened(mesh, most, top);
  const auto within = [&](std::span<const Vec3> vertices, std::span<const Corners> triangles) {
    return std::ranges::count_if(triangles, [&](const Corners& corners) {
      return std::ranges::all_of(corners,
                                 [&](VertexId v) { return distance_to(top, vertices[v]) == 0.0; });
    });
  };
  EXPECT_EQ(within(close.vertices, close.triangles), within(mesh.vertices(), mesh.triangles()));
  const auto there = within(mesh.vertices(), mesh.triangles());
  EXPECT_LE(close.triangles.size(), most + static_cast<std::size_t>(there));
  EXPECT_GT(close.triangles.size(), most / 8 + static_cast<std::size_t>(there));
}

}  // namespace
}  // namespace keepout::app
