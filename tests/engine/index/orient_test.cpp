// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/orient.h"

#include <algorithm>

#include "meshes.h"

namespace keepout {
namespace {

/// Returns the triangles, each starting at its lowest vertex: equal for equal windings.
std::vector<Corners> windings(const Surface& surface) {
  std::vector<Corners> all = surface.triangles;
  for (Corners& c : all) {
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
  }
  return all;
}

/// Orients a surface, and expects the windings of `expected`.
Orientation oriented(Surface surface, const Surface& expected) {
  const Orientation done = orient(surface);
  EXPECT_EQ(windings(surface), windings(expected));
  return done;
}

/// Returns the surface with the given triangles flipped.
Surface turned(Surface surface, std::initializer_list<std::size_t> triangles) {
  for (const std::size_t t : triangles) std::swap(surface.triangles[t][0], surface.triangles[t][1]);
  return surface;
}

/// Returns the surface five times as large, about the same center.
Surface around(Surface surface) {
  for (Vec3& v : surface.vertices) v = 5.0 * (v - Vec3::Constant(0.2)) + Vec3::Constant(0.2);
  return surface;
}

/// Returns a cube centered at the origin.
Surface cube(double width) {
  Surface surface = make_cube(100.0);  // one square per side
  for (Vec3& v : surface.vertices) v *= width / 100.0;
  return surface;
}

/// Returns a strip of `count` quadrilaterals around the z axis. Its end is joined to its beginning
/// after a half turn.
Surface moebius_strip(VertexId count) {
  Surface surface;
  for (VertexId i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    const Vec3 outward(std::cos(angle), std::sin(angle), 0.0);
    const Vec3 across = std::cos(angle / 2) * outward + std::sin(angle / 2) * Vec3::UnitZ();
    surface.vertices.push_back(5.0 * outward - across);
    surface.vertices.push_back(5.0 * outward + across);
  }
  for (VertexId i = 0; i < count; ++i) {
    const bool is_last = i + 1 == count;
    const VertexId a = 2 * i, b = 2 * i + 1;
    const VertexId c = is_last ? 1 : 2 * i + 2, d = is_last ? 0 : 2 * i + 3;
    surface.triangles.push_back({a, c, b});
    surface.triangles.push_back({b, c, d});
  }
  return surface;
}

TEST(Orient, TurnedTrianglesOfACubeAreTurnedBack) {
  const Surface cube = make_cube(50.0);
  const Orientation done = oriented(turned(cube, {0, 3, 7}), cube);
  EXPECT_EQ(done.turned, 3u);
  EXPECT_EQ(done.disagreeing, 3u);
  EXPECT_EQ(done.parts, 1u);
  EXPECT_EQ(done.closed_parts, 1u);
  EXPECT_EQ(done.inside_out_parts, 0u);
}

TEST(Orient, AClosedPartThatIsInsideOutIsTurnedAsAWhole) {
  const Surface sound = torus(10);
  const Orientation done = oriented(turned(flipped(sound), {5}), sound);
  EXPECT_EQ(done.disagreeing, 1u);
  EXPECT_EQ(done.turned, 199u);
  EXPECT_EQ(done.inside_out_parts, 1u);
}

TEST(Orient, EachPartIsDecidedByItself) {
  const Surface sound = together(tetrahedron(), moved(tetrahedron(), {1e4, 0, 0}));
  const Orientation done =
      oriented(together(tetrahedron(), flipped(moved(tetrahedron(), {1e4, 0, 0}))), sound);
  EXPECT_EQ(done.closed_parts, 2u);
  EXPECT_EQ(done.inside_out_parts, 1u);
  EXPECT_EQ(done.nested_parts, 0u);
}

TEST(Orient, APartWithinAnotherKeepsItsWindingRelativeToIt) {
  const Surface hollow = together(flipped(tetrahedron()), around(tetrahedron()));
  EXPECT_EQ(oriented(hollow, hollow).nested_parts, 1u);
  const Orientation done = oriented(turned(flipped(hollow), {6}), hollow);
  EXPECT_EQ(done.inside_out_parts, 1u);
  EXPECT_EQ(done.nested_parts, 1u);
  const Surface island = together(tetrahedron(), around(tetrahedron()));
  EXPECT_EQ(oriented(island, island).turned, 0u);
}

TEST(Orient, BesideIsNotWithin) {
  // The small part is in the bounding box of the large part, but outside its slanted face.
  Surface small = tetrahedron();
  for (Vec3& v : small.vertices) v = 0.1 * v + Vec3::Constant(0.8);
  const Orientation done =
      oriented(together(tetrahedron(), flipped(small)), together(tetrahedron(), small));
  EXPECT_EQ(done.nested_parts, 0u);
  EXPECT_EQ(done.inside_out_parts, 1u);
}

TEST(Orient, APartThatPokesOutOfAnotherFacesOutward) {
  // The first vertex of the small part is in the large part; others are outside its slanted face.
  Surface large = tetrahedron();
  for (Vec3& v : large.vertices) v *= 100.0;
  const Surface small = moved(cube(8.0), {32.0, 32.0, 32.0});
  ASSERT_LT(small.vertices[0].sum(), 100.0);
  Surface surface = together(large, flipped(small));
  const Orientation done = orient(surface);
  EXPECT_EQ(windings(surface), windings(together(large, small)));
  EXPECT_EQ(done.crossing_parts, 1u);
  EXPECT_EQ(done.inside_out_parts, 1u);
  EXPECT_EQ(done.nested_parts, 0u);
  // This part also pokes out of the bounding box.
  surface = together(large, flipped(moved(small, {-32.0, 0, 0})));
  EXPECT_EQ(orient(surface).crossing_parts, 1u);
}

TEST(Orient, ManyPartsAreDecidedAsOneByOne) {
  // A lattice of nested shells: solid, cavity, island. Every second group is inside out.
  constexpr int wide = 6;
  Surface sound, surface;
  for (int i = 0; i < wide * wide * wide; ++i) {
    const Vec3 at(100.0 * (i % wide), 100.0 * (i / wide % wide), 100.0 * (i / wide / wide));
    const Surface shells =
        moved(together(together(cube(60.0), flipped(cube(40.0))), cube(20.0)), at);
    sound = together(sound, shells);
    surface = together(surface, i % 2 == 0 ? shells : flipped(shells));
  }
  const Orientation done = orient(surface);
  EXPECT_EQ(windings(surface), windings(sound));
  EXPECT_EQ(done.nested_parts, 2u * wide * wide * wide);
  EXPECT_EQ(done.crossing_parts, 0u);
}

TEST(Orient, AnOpenSurfaceAgreesAndKeepsMostWindings) {
  const Surface open = opened(flipped(tetrahedron()));
  const Orientation done = oriented(turned(open, {1}), open);
  EXPECT_EQ(done.open_parts, 1u);
  EXPECT_EQ(done.closed_parts, 0u);
  EXPECT_EQ(done.turned, 1u);
}

TEST(Orient, AMoebiusStripIsLeftAsItIs) {
  const Surface strip = moebius_strip(9);
  Surface surface = strip;
  const Orientation done = orient(surface);
  EXPECT_EQ(done.one_sided_parts, 1u);
  EXPECT_EQ(done.parts, 1u);
  EXPECT_EQ(done.turned, 0u);
  EXPECT_EQ(surface.triangles, strip.triangles);
}

TEST(Orient, PartsEndAtNonManifoldEdges) {
  Surface surface = weld(make_non_manifold(10.0));
  const Orientation done = orient(surface);
  EXPECT_EQ(done.non_manifold_parts, 5u);
  EXPECT_EQ(done.parts, 5u);
}

TEST(Orient, SolidsThatTouchAlongAnEdgeAreClosed) {
  Surface other = tetrahedron();
  for (Vec3& v : other.vertices) v = {v.x(), -v.y(), -v.z()};  // half a turn about x
  const Surface sound = weld(together(tetrahedron(), other));
  const Orientation done = oriented(flipped(sound), sound);
  EXPECT_EQ(done.closed_parts, 2u);
  EXPECT_EQ(done.inside_out_parts, 2u);
}

TEST(Orient, ASheetOfTwoLayersHasNoOutside) {
  Surface surface = single_triangle();
  surface.triangles.push_back({0, 2, 1});
  EXPECT_EQ(orient(surface).flat_parts, 1u);
}

}  // namespace
}  // namespace keepout
