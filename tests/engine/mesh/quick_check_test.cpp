// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "keepout/mesh/diagnostics.h"
#include "meshes.h"
#include "messages.h"

namespace keepout {
namespace {

void expect_diagnostics(const Mesh& mesh, std::string_view what) {
  const MeshFindings findings = examine(mesh);
  for (const unsigned threads : {1u, 3u}) {
    const EdgeFaults faults = find_edge_faults(mesh, threads);
    EXPECT_EQ(faults.boundary, findings.boundary_edges > 0) << what;
    EXPECT_EQ(faults.inconsistent, findings.inconsistent_edges > 0) << what;
  }
}

TEST(QuickCheck, AgreesWithExamineOnEveryShape) {
  for (const Shape& shape : shapes()) {
    expect_diagnostics(Mesh(shape.make()), shape.name);
  }
}

TEST(QuickCheck, FindsOneMissingTriangleAndOneTurnedOneAmongThousands) {
  Random random(20261122);
  for (const Shape& shape : shapes()) {
    Surface missing = shape.make();
    Surface turned = missing;
    Surface both = missing;
    const std::size_t some = random.below(missing.triangles.size());
    const std::size_t other = random.below(missing.triangles.size() - 1);
    std::swap(turned.triangles[some][0], turned.triangles[some][1]);
    std::swap(both.triangles[some][0], both.triangles[some][1]);
    for (Surface* surface : {&missing, &both}) {
      surface->triangles[other] = surface->triangles.back();
      surface->triangles.pop_back();
    }
    expect_diagnostics(Mesh(std::move(missing)), shape.name);
    expect_diagnostics(Mesh(std::move(turned)), shape.name);
    expect_diagnostics(Mesh(std::move(both)), shape.name);
  }
}

TEST(QuickCheck, OfASoundMeshThereIsNothingToSay) {
  EXPECT_TRUE(quick_check(Mesh(make_cube(10.0))).empty());
  EXPECT_TRUE(quick_check(Mesh(make_shape("far_cube"))).empty());
}

/// Returns the cube of 100 mm, scaled by `factor`.
Mesh cube_times(double factor) { return Mesh(enlarged(make_cube(25.0), factor)); }

TEST(QuickCheck, ASizeThatNoAnatomyHasIsSaidToBeInAnotherUnit) {
  const auto metres = quick_check(cube_times(0.001));
  ASSERT_EQ(metres.size(), 1u);
  EXPECT_CONTAINS(
      metres[0],
      "the mesh is 0.1 mm across if its unit is mm; in m it would be 100 mm across: scale "
      "it to mm, or give the unit of the file, for example --unit m or unit=\"m\"");
  const auto micrometres = quick_check(cube_times(1000.0));
  ASSERT_EQ(micrometres.size(), 1u);
  EXPECT_CONTAINS(micrometres[0], "the mesh is 100000 mm across");
  EXPECT_CONTAINS(micrometres[0], "in um it would be 100 mm across");
  EXPECT_TRUE(quick_check(cube_times(0.25)).empty());  // as large as an aneurysm
  const auto scaled = quick_check(cube_times(1000.0), 0, 1000.0);
  ASSERT_EQ(scaled.size(), 1u);
  EXPECT_CONTAINS(scaled[0], "100000 mm across after it was scaled by 1000");
}

TEST(QuickCheck, OfVerticesThatCoincideNoUnitIsAskedFor) {
  const Mesh point(Surface{.vertices = {{1, 2, 3}}, .triangles = {{0, 0, 0}}});
  const auto found = quick_check(point);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_CONTAINS(found[0], "all vertices coincide");
  EXPECT_FALSE(examine(point).looks_like_meters());
}

TEST(QuickCheck, AnOpenAndAnInconsistentSurfaceAreSaidToBeSo) {
  Surface surface = opened(make_cube(10.0));
  const auto open = quick_check(Mesh(surface));
  ASSERT_EQ(open.size(), 1u);
  EXPECT_CONTAINS(open[0], "the surface is open");
  std::swap(surface.triangles[3][0], surface.triangles[3][1]);
  const auto both = quick_check(Mesh(surface));
  ASSERT_EQ(both.size(), 2u);
  EXPECT_CONTAINS(both[1], "wound inconsistently");
}

TEST(QuickCheck, AClosedSurfaceThatFacesInwardIsReported) {
  for (Surface surface : {make_cube(10.0), make_shape("far_cube")}) {
    for (auto& triangle : surface.triangles) std::swap(triangle[0], triangle[1]);
    const auto inward = quick_check(Mesh(surface));
    ASSERT_EQ(inward.size(), 1u);
    EXPECT_CONTAINS(inward[0], "closed and faces inward");
    EXPECT_CONTAINS(inward[0], "flip it: --flip or flip=True");
  }
}

TEST(QuickCheck, TrianglesThatNameAVertexTwiceHaveNoEdges) {
  Surface surface = make_cube(10.0);
  surface.triangles.push_back({0, 1, 1});
  surface.triangles.push_back({2, 2, 2});
  EXPECT_TRUE(quick_check(Mesh(std::move(surface))).empty());
}

TEST(Watertight, AgreesWithExamine) {
  std::size_t watertight = 0;
  for (const Shape& shape : shapes()) {
    const Mesh mesh(shape.make());
    EXPECT_EQ(is_watertight(mesh), examine(mesh).is_watertight()) << shape.name;
    watertight += is_watertight(mesh);
  }
  EXPECT_GT(watertight, 5u);
  EXPECT_LT(watertight, shapes().size());
}

TEST(Watertight, OneTriangleMoreLessOrTheOtherWayRoundIsNot) {
  const Surface cube = make_shape("cube");
  EXPECT_TRUE(is_watertight(Mesh(cube)));
  EXPECT_FALSE(is_watertight(Mesh(opened(cube))));
  Surface more = cube;
  more.triangles.push_back(cube.triangles.front());
  EXPECT_FALSE(is_watertight(Mesh(more)));
  Surface turned = cube;
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  EXPECT_FALSE(is_watertight(Mesh(turned)));
}

}  // namespace
}  // namespace keepout
