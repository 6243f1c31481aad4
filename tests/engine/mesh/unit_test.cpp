// SPDX-License-Identifier: BSD-3-Clause
// Units, scales and winding on request of the caller.
#include <limits>

#include "engine/mesh/mesh_files.h"

namespace keepout {
namespace {

using Sentences = std::vector<std::string>;

class LoadUnit : public LoadMesh {
 protected:
  LoadedMesh load_with(const LoadOptions& options) const {
    return load_mesh(folder.write("mesh.off", as_off(tetrahedron())), options);
  }
  std::string complaint_about(const LoadOptions& options) const {
    return error_of([&] { load_with(options); });
  }
};

TEST_F(LoadUnit, AUnitIsScaledToMillimetresAndReported) {
  const LoadedMesh plain = load_with({.check = MeshCheck::none});
  const std::vector<std::pair<std::string, double>> units{
      {"m", 1000.0}, {"cm", 10.0}, {"um", 0.001}, {"in", 25.4}};
  for (const auto& [unit, factor] : units) {
    const LoadedMesh scaled = load_with({.unit = unit, .check = MeshCheck::none});
    EXPECT_EQ(scaled.scale, factor);
    ASSERT_EQ(scaled.mesh->vertex_count(), plain.mesh->vertex_count());
    for (VertexId v = 0; v < plain.mesh->vertex_count(); ++v) {
      EXPECT_EQ(scaled.mesh->vertex(v), plain.mesh->vertex(v) * factor) << unit;
    }
    EXPECT_EQ(scaled.notices,
              Sentences{"mesh.off: scaled by " + number(factor) + ", from " + unit + " to mm"});
    EXPECT_TRUE(scaled.warnings.empty());
  }
  const LoadedMesh same = load_with({.unit = "mm"});
  EXPECT_EQ(same.scale, 1.0);
  EXPECT_TRUE(same.notices.empty());
  EXPECT_TRUE(std::ranges::equal(same.mesh->vertices(), plain.mesh->vertices()));
}

TEST_F(LoadUnit, AScaleOfItsOwnIsReported) {
  const LoadedMesh scaled = load_with({.scale = 2.5});
  EXPECT_EQ(scaled.scale, 2.5);
  EXPECT_EQ(scaled.notices, Sentences{"mesh.off: scaled by 2.5"});
}

TEST_F(LoadUnit, AFlippedMeshIsWoundTheOtherWayAndReported) {
  const LoadedMesh plain = load_with({});
  const LoadedMesh flipped = load_with({.flip = true});
  EXPECT_FALSE(plain.flipped);
  EXPECT_TRUE(flipped.flipped);
  EXPECT_EQ(flipped.notices, Sentences{"mesh.off: flipped: each triangle is wound the other way"});
  for (TriangleId t = 0; t < plain.mesh->triangle_count(); ++t) {
    EXPECT_EQ(flipped.mesh->normal(t), -plain.mesh->normal(t));
  }
}

TEST_F(LoadUnit, WhatIsNoUnitOrScaleIsOneSentence) {
  EXPECT_EQ(complaint_about({.unit = "inch"}),
            "unit must be one of 'm', 'cm', 'mm', 'um', 'in', the unit of the lengths in the file, "
            "not 'inch'");
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, infinite, std::nan("")}) {
    const std::string text = complaint_about({.scale = bad});
    EXPECT_CONTAINS(text, "scale must be a finite number above 0");
    EXPECT_CONTAINS(text, "not " + number(bad));
  }
  EXPECT_CONTAINS(complaint_about({.unit = "m", .scale = 3.0}), "one of them, not both");
  for (const double huge : {1e308, 1e32}) {
    EXPECT_CONTAINS(complaint_about({.scale = huge}), "beyond 1e30; check the unit or the scale");
  }
}

TEST_F(LoadUnit, AUnitThatTheFileContradictsIsWarnedOf) {
  const std::string text =
      "# vertex coordinates are measured in units, where 1 unit = 10.000000 mm\n" +
      as_obj(tetrahedron());
  const fs::path file = folder.write("mesh.obj", text);
  const LoadedMesh agreed = load_mesh(file, {.unit = "cm"});
  EXPECT_TRUE(agreed.warnings.empty());
  for (const std::string unit : {"m", "mm"}) {
    const LoadedMesh other = load_mesh(file, {.unit = unit, .check = MeshCheck::none});
    ASSERT_EQ(other.warnings.size(), 1u);
    EXPECT_CONTAINS(other.warnings[0],
                    "mesh.obj: the file states that 1 unit is 10 mm, but it was read as if 1 unit "
                    "were " +
                        std::string(unit == "m" ? "1000" : "1") + " mm");
  }
}

TEST_F(LoadUnit, AMeshThatTheUnitMakesTooLargeIsWarnedOf) {
  const fs::path file = folder.write("mesh.off", as_off(enlarged(tetrahedron(), 100.0)));
  EXPECT_TRUE(load_mesh(file).warnings.empty());
  const LoadedMesh large = load_mesh(file, {.unit = "m"});
  ASSERT_EQ(large.warnings.size(), 1u);
  EXPECT_CONTAINS(large.warnings[0], "after it was scaled by 1000");
}

TEST_F(LoadUnit, VerticesThatScalingMakesEqualAreWelded) {
  const std::string text = "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1e-320 0 0\n3 0 1 2\n3 3 2 1\n";
  const LoadedMesh loaded =
      load_mesh(folder.write("mesh.off", text), {.unit = "um", .check = MeshCheck::none});
  EXPECT_EQ(loaded.mesh->vertex_count(), 4u);
  EXPECT_EQ(load_mesh(folder.write("mesh.off", text), {.scale = 1e-9, .check = MeshCheck::none})
                .mesh->vertex_count(),
            3u);
}

TEST_F(LoadUnit, WarningsBeginWithTheNameOfTheFile) {
  const LoadedMesh open = load("open.off", square_off);
  ASSERT_EQ(open.warnings.size(), 2u);
  EXPECT_TRUE(open.warnings[0].starts_with("open.off: the mesh is 1 mm across if its unit is mm"));
  EXPECT_EQ(open.warnings[1],
            "open.off: the surface is open: nothing is guarded where triangles are missing");
}

}  // namespace
}  // namespace keepout
