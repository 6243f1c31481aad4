// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "commands.h"
#include "keepout/mesh/binary_stl.h"
#include "meshes.h"
#include "temporary_folder.h"

namespace keepout::app {
namespace {

class Inspect : public testing::Test {
 protected:
  void write(const Surface& surface, double scale = 100.0) {
    write_binary_stl(file, enlarged(surface, scale));
  }
  std::string text(bool self_intersections = false) const {
    std::ostringstream out;
    inspect({.mesh = file, .self_intersections = self_intersections}, out);
    return out.str();
  }
  nlohmann::json json(bool self_intersections = false) const {
    std::ostringstream out;
    inspect({.mesh = file, .json = true, .self_intersections = self_intersections}, out);
    return nlohmann::json::parse(out.str());
  }
  std::set<std::string> finding_keys() const {
    std::set<std::string> keys;
    const nlohmann::json report = json();
    for (const nlohmann::json& finding : report.at("findings")) keys.insert(finding.at("key"));
    return keys;
  }

  TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "mesh.stl";
};

TEST_F(Inspect, ASoundMeshHasNoFindings) {
  write(tetrahedron());
  EXPECT_CONTAINS(text(), "Findings\n  none\n");
  EXPECT_CONTAINS(text(), "watertight");
  EXPECT_TRUE(json().at("findings").empty());
}

TEST_F(Inspect, TheNumbersAreThoseOfTheMesh) {
  write(tetrahedron());
  const nlohmann::json report = json();
  EXPECT_EQ(report.at("mesh"), file.string());
  EXPECT_EQ(report.at("unit"), "mm");
  EXPECT_EQ(report.at("triangles"), 4);
  EXPECT_EQ(report.at("vertices"), 4);
  EXPECT_EQ(report.at("edges"), 6);
  EXPECT_EQ(report.at("components"), 1);
  EXPECT_EQ(report.at("watertight"), true);
  EXPECT_EQ(report.at("genus"), 0);
  EXPECT_EQ(report.at("bounds").at("high"), nlohmann::json({100.0, 100.0, 100.0}));
  EXPECT_NEAR(report.at("signed_volume").get<double>(), 1e6 / 6.0, 1e-3);
  EXPECT_EQ(report.at("self_intersections"), nullptr);
}

TEST_F(Inspect, LargeNumbersAreGrouped) {
  write(torus(32));
  EXPECT_CONTAINS(text(), "2,048");
}

TEST_F(Inspect, EachFindingSaysHowManyWhatItMeansAndWhatToDo) {
  write(opened(tetrahedron()));
  EXPECT_CONTAINS(text(), "3 boundary edges: the surface is open");
  EXPECT_CONTAINS(text(), "What to do: close the holes");
  const nlohmann::json finding = json().at("findings").at(0);
  EXPECT_EQ(finding.at("key"), "boundary_edges");
  EXPECT_EQ(finding.at("count"), 3);
  EXPECT_FALSE(finding.at("meaning").get<std::string>().empty());
  EXPECT_FALSE(finding.at("advice").get<std::string>().empty());
  EXPECT_EQ(json().at("genus"), nullptr);
}

TEST_F(Inspect, TheUnitAndTheOrientationAreQuestioned) {
  write(flipped(tetrahedron()), 1.0);
  EXPECT_EQ(finding_keys(), (std::set<std::string>{"inside_out", "looks_like_meters"}));
}

TEST_F(Inspect, WhatIsFarTooLargeIsQuestionedToo) {
  write(tetrahedron(), 150'000.0);
  EXPECT_EQ(finding_keys(), std::set<std::string>{"looks_like_micrometers"});
  EXPECT_CONTAINS(text(), "um (150 mm)");
  EXPECT_EQ(json().at("other_units").at(0).at("unit"), "um");
  EXPECT_EQ(json().at("looks_like_micrometers"), true);
}

TEST_F(Inspect, PlausibleUnitsAreNamedWithTheSizeThatTheyMake) {
  const auto units_at = [&](double size) {
    write(tetrahedron(), size);
    std::set<std::string> units;
    const nlohmann::json report = json();
    for (const nlohmann::json& guess : report.at("other_units")) units.insert(guess.at("unit"));
    return units;
  };
  using Units = std::set<std::string>;
  EXPECT_EQ(units_at(0.18), Units{"m"});
  EXPECT_EQ(units_at(0.5), Units{"m"});
  EXPECT_EQ(units_at(2.5), (Units{"cm", "in"}));
  EXPECT_EQ(units_at(7.1), (Units{"cm", "in"}));
  EXPECT_EQ(units_at(150.0), Units{});
  EXPECT_EQ(units_at(1e6), Units{});
  write(tetrahedron(), 0.18);
  EXPECT_CONTAINS(text(), "mm, which is assumed; as plausible: m (180 mm)");
}

TEST_F(Inspect, TheAnatomicalSpaceIsPrintedAndHowItIsKnown) {
  write(tetrahedron());
  EXPECT_CONTAINS(text(), "the file states neither RAS nor LPS");
  EXPECT_EQ(json().at("space"), nullptr);
  std::fstream out(file, std::ios::in | std::ios::out | std::ios::binary);
  out << std::string("3D Slicer output. SPACE=LPS").append(53, '\0');
  out.close();
  EXPECT_CONTAINS(text(), "LPS, as stated in the file");
  EXPECT_CONTAINS(text(), ": the file states SPACE=LPS: taken as it stands");
  EXPECT_EQ(json().at("space"), "LPS");
  std::ostringstream turned;
  inspect({.mesh = file, .load = {.space = AnatomicalSpace::ras}}, turned);
  EXPECT_CONTAINS(turned.str(), "RAS, turned from LPS");
  EXPECT_CONTAINS(turned.str(), "Findings\n  none\n");
}

TEST_F(Inspect, EveryKindOfFindingIsReported) {
  Surface surface = tetrahedron();
  std::swap(surface.triangles[0][0], surface.triangles[0][1]);  // inconsistent
  surface = together(surface, moved(tetrahedron(), {5, 0, 0}));
  surface.triangles.push_back(surface.triangles[5]);  // duplicate, non-manifold
  surface.triangles.push_back({1, 1, 2});             // degenerate
  surface.vertices.emplace_back(-1, 0, 0);
  surface.vertices.emplace_back(0, -1, 0);
  surface.triangles.push_back({0, 8, 9});  // open, pinched
  write(surface);
  EXPECT_EQ(finding_keys(), (std::set<std::string>{"inconsistent_edges", "boundary_edges",
                                                   "non_manifold_edges", "duplicate_triangles",
                                                   "degenerate_triangles", "pinched_vertices"}));
  EXPECT_CONTAINS(text(), "1 duplicate triangle:");
}

TEST_F(Inspect, SelfIntersectionsAreCountedOnRequest) {
  write(together(tetrahedron(), moved(tetrahedron(), {0.25, 0.25, -0.25})));
  EXPECT_LACKS(text(), "intersecting");
  EXPECT_CONTAINS(text(true), "self-intersecting pairs");
  EXPECT_GT(json(true).at("self_intersections"), 0);
}

TEST_F(Inspect, EachFindingSaysWhere) {
  Surface open = opened(tetrahedron());
  open = together(open, moved(open, {10, 0, 0}));
  open = together(open, moved(open, {0, 10, 0}));
  write(open);
  EXPECT_CONTAINS(text(),
                  "Where: near (50, 50, 0), (1050, 50, 0), (50, 1050, 0) mm, and in 1 more place.");
  const nlohmann::json finding = json().at("findings").at(0);
  EXPECT_EQ(finding.at("key"), "boundary_edges");
  EXPECT_EQ(finding.at("groups"), 4);
  EXPECT_EQ(finding.at("places").size(), 10u);  // of twelve edges
  EXPECT_EQ(finding.at("places")[0].at("at"), nlohmann::json({50.0, 50.0, 0.0}));
  EXPECT_EQ(finding.at("places")[0].at("corners"),
            nlohmann::json({{0.0, 100.0, 0.0}, {100.0, 0.0, 0.0}}));
}

TEST_F(Inspect, SelfIntersectionsHavePlacesToo) {
  write(together(tetrahedron(), moved(tetrahedron(), {0.25, 0.25, -0.25})));
  const nlohmann::json report = json(true);
  const nlohmann::json& finding = report.at("findings").at(0);
  EXPECT_EQ(finding.at("key"), "self_intersections");
  EXPECT_EQ(finding.at("places")[0].at("corners").size(), 6u);
  EXPECT_CONTAINS(text(true), "Where: near (");
}

TEST_F(Inspect, APageIsMadeOfTheMeshAndItsFaults) {
  write(opened(tetrahedron()));
  const std::filesystem::path page = folder.path() / "page.html";
  std::ostringstream out;
  inspect({.mesh = file, .page = page, .command = "keepout inspect mesh.stl"}, out);
  EXPECT_CONTAINS(out.str(), "\nPage, with tables, no pictures: " + page.string() + "\n");
  // Without the front end of pages, a plain page is written, and the record beside it.
  EXPECT_CONTAINS(folder.contents("page.html"), "boundary_edges");
  const nlohmann::json record = nlohmann::json::parse(folder.contents("page.html.json"));
  EXPECT_EQ(record.at("keepout_record"), "inspect");
  EXPECT_EQ(record.at("headline"), "mesh.stl: 3 boundary edges.");
  EXPECT_EQ(record.at("mesh").at("surface"), "open");
  EXPECT_EQ(record.at("inspection").at("findings").at(0).at("places").size(), 3u);
  std::ostringstream json;
  inspect({.mesh = file, .json = true, .page = page}, json);
  EXPECT_EQ(nlohmann::json::parse(json.str()).at("boundary_edges"), 3);
  EXPECT_CONTAINS(error_of([&] { inspect({.mesh = file, .page = file}, out); }),
                  "is the same file as MESH");
}

TEST_F(Inspect, WarningsOfTheReaderAreAmongTheFindings) {
  file = folder.write("mesh.obj", "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\nl 1 2\n");
  EXPECT_CONTAINS(text(), "mesh.obj: 1 lines or points are left out");
  EXPECT_EQ(json().at("warnings").size(), 1u);
}

TEST_F(Inspect, AFileThatCannotBeReadIsAnErrorAndPrintsNothing) {
  file = folder.path() / "absent.stl";
  std::ostringstream out;
  EXPECT_THROW(inspect({.mesh = file}, out), Error);
  EXPECT_TRUE(out.str().empty());
}

TEST_F(Inspect, AFileNameThatIsNotUtf8StillMakesJson) {
  file = folder.path() / "m\xfc.stl";
  write(tetrahedron());
  EXPECT_EQ(json().at("triangles"), 4);
}

}  // namespace
}  // namespace keepout::app
