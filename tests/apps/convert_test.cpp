// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "command_process.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/mesh/diagnostics.h"
#include "keepout/mesh/load_mesh.h"
#include "meshes.h"

namespace keepout::app {
namespace {

using test::CommandFolder;
using test::succeeded;

LoadedMesh load(const std::filesystem::path& file) {
  return load_mesh(file, {.check = MeshCheck::none});
}

/// Returns the triangles by the coordinates of their corners, each with its lowest corner first.
std::vector<std::array<std::array<double, 3>, 3>> triangles_of(const Mesh& mesh) {
  std::vector<std::array<std::array<double, 3>, 3>> all;
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    auto& corners = all.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& v = mesh.vertex(mesh.corners(t)[i]);
      corners[i] = {v.x(), v.y(), v.z()};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  }
  return all;
}

/// Returns an OBJ file of a cube of twelve triangles, 40 mm wide, with some texts replaced.
std::string cube_with(std::initializer_list<std::pair<std::string, std::string>> changes) {
  std::string text =
      "v -20 -20 -20\nv 20 -20 -20\nv 20 20 -20\nv -20 20 -20\n"
      "v -20 -20 20\nv 20 -20 20\nv 20 20 20\nv -20 20 20\n"
      "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\n"
      "f 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";
  for (const auto& [from, to] : changes) text.replace(text.find(from), from.size(), to);
  return text;
}

TEST(Convert, TurnedTrianglesOfACubeAreTurnedBack) {
  const CommandFolder folder;
  const auto sound = load(folder.write("cube.obj", cube_with({}))).mesh;
  folder.write("bad.obj", cube_with({{"f 5 6 7", "f 6 5 7"}, {"f 4 1 5", "f 4 5 1"}}));
  for (const std::string file : {"out.stl", "out.ply", "OUT.PLY"}) {
    const auto outcome = succeeded(folder.run("convert bad.obj " + file + " --orient"));
    EXPECT_CONTAINS(outcome.output, "triangles     12 in, 12 out");
    EXPECT_CONTAINS(outcome.output, "vertices      8 in, 8 out");
    EXPECT_CONTAINS(outcome.output, "2 of 12 triangles: 2 disagreed with most of their part");
    EXPECT_CONTAINS(outcome.output, "1 closed part, none inside out");
    const LoadedMesh written = load(folder.file(file));
    EXPECT_TRUE(is_watertight(*written.mesh));
    EXPECT_EQ(triangles_of(*written.mesh), triangles_of(*sound));
  }
}

TEST(Convert, WithoutOrientTheWindingStays) {
  const CommandFolder folder;
  const auto given = load(folder.write("bad.obj", cube_with({{"f 5 6 7", "f 6 5 7"}}))).mesh;
  const auto outcome = succeeded(folder.run("convert bad.obj out.ply"));
  EXPECT_CONTAINS(outcome.output, "turned        none; --orient");
  EXPECT_CONTAINS(outcome.output, "out.ply: the surface is wound inconsistently");
  EXPECT_EQ(triangles_of(*load(folder.file("out.ply")).mesh), triangles_of(*given));
}

TEST(Convert, FaultyTrianglesAreDroppedAndVerticesWelded) {
  const CommandFolder folder;
  folder.write("bad.obj", cube_with({}) + "v -20 -20 -20\nf 9 3 2\nf 1 2 3\nf 4 4 5\n");
  const auto outcome = succeeded(folder.run("convert bad.obj out.ply --orient"));
  EXPECT_CONTAINS(outcome.output, "triangles     15 in, 12 out");
  EXPECT_CONTAINS(outcome.output, "vertices      9 in, 8 out");
  EXPECT_CONTAINS(outcome.output,
                  "1 degenerate triangle, 2 duplicate triangles (1 wound opposite to the one");
  const MeshFindings found = examine(*load(folder.file("out.ply")).mesh);
  EXPECT_TRUE(found.is_watertight());
  EXPECT_EQ(found.duplicate_triangles + found.degenerate_triangles(), 0u);
}

TEST(Convert, WhatCannotBeDecidedIsSaid) {
  const CommandFolder folder;
  folder.write("open.obj", cube_with({{"f 5 6 7\n", ""}}));
  const auto outcome = succeeded(folder.run("convert open.obj out.stl --orient"));
  EXPECT_CONTAINS(outcome.output, "undecided     1 open part: neighbors agree");
  EXPECT_CONTAINS(outcome.output, "out.stl: the surface is open");
}

TEST(Convert, PartsThatCrossAreCounted) {
  const CommandFolder folder;
  // A tetrahedron with its tip inside the cube.
  folder.write("cross.obj", cube_with({}) +
                                "v 0 0 0\nv 0 0 60\nv 30 0 60\nv 0 30 60\n"
                                "f 9 10 11\nf 9 12 10\nf 9 11 12\nf 10 12 11\n");
  EXPECT_CONTAINS(succeeded(folder.run("convert cross.obj out.stl --orient")).output,
                  "crossing      1 closed part, included in those: only partly within another");
}

TEST(Convert, SpacesAreTurnedAndStated) {
  const CommandFolder folder;
  folder.write("cube.obj", cube_with({{"v 20 20 20", "v 21 22 23"}}));
  EXPECT_CONTAINS(succeeded(folder.run("convert cube.obj lps.ply --untagged lps")).output,
                  "space         LPS");
  EXPECT_EQ(load(folder.file("lps.ply")).stated, AnatomicalSpace::lps);
  succeeded(folder.run("convert lps.ply ras.stl --space ras"));
  const LoadedMesh turned = load(folder.file("ras.stl"));
  EXPECT_EQ(turned.stated, AnatomicalSpace::ras);
  EXPECT_EQ(turned.mesh->bounds().low, Vec3(-21, -22, -20));
  EXPECT_CONTAINS(succeeded(folder.run("convert cube.obj plain.ply")).output,
                  "space         unstated");
}

TEST(Convert, UnitsAreScaledAndWindingsFlipped) {
  const CommandFolder folder;
  const auto sound = load(folder.write("cube.obj", cube_with({}))).mesh;
  const auto outcome = succeeded(folder.run("convert cube.obj cm.ply --unit cm --flip"));
  EXPECT_CONTAINS(outcome.output, "cube.obj: scaled by 10");
  EXPECT_EQ(load(folder.file("cm.ply")).mesh->bounds().high, Vec3(200, 200, 200));
  EXPECT_TRUE(examine(*load(folder.file("cm.ply")).mesh).is_inside_out());
  succeeded(folder.run("convert cm.ply back.ply --scale 0.1 --orient"));
  EXPECT_EQ(triangles_of(*load(folder.file("back.ply")).mesh), triangles_of(*sound));
}

TEST(Convert, RoundingForStlIsSaidAndWelds) {
  const CommandFolder folder;
  // Corners that differ by 1e-9 are equal in single precision.
  folder.write("cube.obj", cube_with({{"v 20 20 20", "v 20.000000001 20 20"}}) +
                               "v 20.000000002 20 20\nf 7 9 8\n");
  const auto stl = succeeded(folder.run("convert cube.obj out.stl"));
  EXPECT_CONTAINS(stl.output, "rounded       coordinates to single precision, by at most");
  EXPECT_CONTAINS(stl.output, "9 in, 8 out");
  EXPECT_CONTAINS(stl.output, "1 degenerate triangle");
  const auto ply = succeeded(folder.run("convert cube.obj out.ply"));
  EXPECT_LACKS(ply.output, "rounded");
  EXPECT_EQ(load(folder.file("out.ply")).mesh->vertex_count(), 9u);
}

TEST(Convert, AFixtureIsAMeshToo) {
  const CommandFolder folder;
  succeeded(folder.run("convert gear gear.ply"));
  EXPECT_TRUE(is_watertight(*load(folder.file("gear.ply")).mesh));
}

TEST(Convert, WrongCommandLinesAreRefused) {
  const CommandFolder folder;
  folder.write("cube.obj", cube_with({}));
  for (const std::string arguments : {"convert cube.obj out.obj", "convert cube.obj out",
                                      "convert cube.obj", "convert cube.obj a.ply b.ply"}) {
    EXPECT_EQ(folder.run(arguments).status, 2) << arguments;
  }
  folder.expect_refused("convert cube.obj out.obj", "'out.obj' ends in neither .stl nor .ply");
  EXPECT_FALSE(std::filesystem::exists(folder.file("out.obj")));
}

TEST(Convert, NothingIsWrittenWhereSomethingIsWrong) {
  const CommandFolder folder;
  folder.write("flat.obj", "v 0 0 0\nv 9 0 0\nv 18 0 0\nf 1 2 3\n");
  folder.expect_refused("convert flat.obj out.ply", "nothing is left to write");
  folder.expect_refused("convert absent.obj out.ply", "absent.obj: there is no such file");
  succeeded(folder.run("convert cube cube.ply"));
  const std::string contents = folder.contents("cube.ply");
  folder.expect_refused("convert cube.ply ./cube.ply --orient", "is the same file as IN");
  EXPECT_EQ(folder.contents("cube.ply"), contents);
  std::filesystem::create_directory(folder.file("folder.ply"));
  folder.expect_refused("convert cube.ply folder.ply", "is a folder");
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name == "flat.obj" || name == "cube.ply" || name == "folder.ply") << name;
  }
}

}  // namespace
}  // namespace keepout::app
