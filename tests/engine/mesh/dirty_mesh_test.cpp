// SPDX-License-Identifier: BSD-3-Clause
//
// Broken and unusual real meshes (fixtures/SOURCES.md; `fixtures/prepare dirty`).

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "keepout/error.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/self_intersection.h"
#include "keepout/mesh/diagnostics.h"
#include "keepout/mesh/load_mesh.h"

namespace keepout {
namespace {

namespace fs = std::filesystem;

fs::path dirty_folder() { return fixture_cache() / "dirty"; }

std::vector<fs::path> dirty_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(dirty_folder())) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  return files;
}

class DirtyMesh : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(fs::is_directory(dirty_folder()))
        << dirty_folder() << " is missing: run `fixtures/prepare dirty`";
  }
};

TEST_F(DirtyMesh, EachLoadsOrIsAnErrorNamingTheFile) {
  std::size_t loaded = 0, refused = 0;
  for (const fs::path& file : dirty_files()) {
    SCOPED_TRACE(file);
    try {
      const LoadedMesh mesh = load_mesh(file);
      const MeshFindings findings = examine(*mesh.mesh);
      EXPECT_EQ(findings.triangles, mesh.mesh->triangle_count());
      EXPECT_EQ(findings.unused_vertices, 0u);
      ++loaded;
    } catch (const Error& error) {
      EXPECT_TRUE(std::string_view(error.what()).starts_with(file.string())) << error.what();
      EXPECT_GT(std::string_view(error.what()).size(), file.string().size() + 10);
      ++refused;
    }
  }
  EXPECT_GT(loaded, 20u);
  EXPECT_GT(refused, 5u);
}

/// Known counts. Other programs confirmed at least the first two.
struct Known {
  std::string_view file;
  std::size_t triangles, boundary, non_manifold, inconsistent, degenerate, duplicates;
  std::optional<std::size_t> self_intersections;  // confirmed by CGAL's exact constructions
};

constexpr Known known[] = {
    {"openfoam-examples/motorBike.obj", 331'653, 49, 100'089, 0, 0, 67'326, 67'326},
    {"occt-misc/head.stl", 117'694, 10'915, 64, 24, 0, 0, 403},
    {"occt-misc/motor.stl", 13'506, 10, 162, 0, 6, 24, 8'518},
    {"libcgal-demo/pig.stl", 16'848, 1'296, 0, 0, 0, 0, 70},
    {"libcgal-demo/boeing.off", 2'564, 0, 0, 978, 0, 0, 0},
    {"libcgal-demo/blobby-shuffled.off", 4'050, 0, 0, 3'069, 0, 0, 0},
    {"libcgal-demo/degtri_sliding.off", 8, 6, 0, 0, 4, 0, 3},
    {"assimp-testmodels/sphereWithHole.stl", 285, 9, 0, 0, 0, 0, {}},
    {"openscad-testing-data/bad-stl-wing.stl", 842, 0, 0, 0, 0, 0, 53},
    {"stl-models/missingFace.ascii.stl", 3, 3, 0, 0, 0, 0, 0},
    {"stl-models/wrongHeader.bin.stl", 12, 0, 0, 0, 0, 0, 0},
    {"stl-models/notANumberNormal.ascii.stl", 4, 0, 0, 0, 0, 0, 0},
};

TEST_F(DirtyMesh, KnownFiguresAreFound) {
  for (const Known& expected : known) {
    SCOPED_TRACE(expected.file);
    const LoadedMesh loaded = load_mesh(dirty_folder() / expected.file);
    const MeshFindings findings = examine(*loaded.mesh);
    EXPECT_EQ(findings.triangles, expected.triangles);
    EXPECT_EQ(findings.boundary_edges, expected.boundary);
    EXPECT_EQ(findings.non_manifold_edges, expected.non_manifold);
    EXPECT_EQ(findings.inconsistent_edges, expected.inconsistent);
    EXPECT_EQ(findings.degenerate_triangles(), expected.degenerate);
    EXPECT_EQ(findings.duplicate_triangles, expected.duplicates);
    if (expected.self_intersections) {
      EXPECT_EQ(count_self_intersections(*loaded.mesh, PdTree(loaded.mesh)),
                *expected.self_intersections);
    }
  }
}

TEST_F(DirtyMesh, MalformedFilesAreErrors) {
  for (const std::string_view file :
       {"stl-models/empty.stl", "stl-models/fourVertices.ascii.stl", "stl-models/quad.ascii.stl",
        "stl-models/incorrectFaceCounter.bin.stl", "stl-models/missingEndsolid.ascii.stl",
        "stl-models/missingNormal.ascii.stl", "stl-models/twoVertices.ascii.stl",
        "openscad-testing-data/empty2.stl", "openscad-testing-data/invalidvertex.stl",
        "openscad-testing-data/toomanyvertices.stl", "openscad-testing-data/unparseable.stl"}) {
    EXPECT_THROW(load_mesh(dirty_folder() / file), Error) << file;
  }
}

}  // namespace
}  // namespace keepout
