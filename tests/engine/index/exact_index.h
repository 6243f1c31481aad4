// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "index/wide_bvh/tree.h"
#include "keepout/testing/index_probes.h"

namespace keepout {

/// Fails unless the index returns exactly the triangles that brute force returns.
inline void expect_exact(const Mesh& mesh, const SpatialIndex& index, std::size_t of_each_kind) {
  TriangleBuffer found(mesh.triangle_count());
  for (const Probe& probe : probes(mesh, of_each_kind)) {
    for (const double radius : probe.radii) {
      found.clear();
      index.collect({probe.point, radius}, found);
      ASSERT_FALSE(found.overflowed()) << "a triangle was given twice";
      std::sort(found.begin(), found.end());
      std::vector<TriangleId> expected;
      for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
        if (probe.distances[t] <= radius) expected.push_back(t);
      }
      ASSERT_TRUE(std::equal(found.begin(), found.end(), expected.begin(), expected.end()))
          << found.size() << " triangles instead of " << expected.size() << " at "
          << probe.point.transpose() << " radius " << radius;
    }
  }
}

/// Returns the first triangles of a shape.
inline std::shared_ptr<const Mesh> beginning_of(std::string_view name, std::size_t triangles) {
  Surface surface = make_shape(name);
  EXPECT_LE(triangles, surface.triangles.size());
  surface.triangles.resize(triangles);
  return mesh_of(std::move(surface));
}

/// Returns the same triangles with each vertex moved by `vertex`.
template <class Move>
std::shared_ptr<const Mesh> moved(const Mesh& mesh, const Move& vertex) {
  Surface surface{{}, {mesh.triangles().begin(), mesh.triangles().end()}};
  for (const Vec3& v : mesh.vertices()) surface.vertices.push_back(vertex(v));
  return mesh_of(std::move(surface));
}

/// Fails unless each triangle is in exactly one lane of one leaf, and all leaves but the last are
/// full. The corners must be in lexicographic order, with its parity, within the error of the
/// frame.
inline void expect_leaves_hold(const Mesh& mesh, const TriangleBlocks& blocks) {
  const std::span<const LeafBlock> leaves = blocks.leaves();
  const LeafFrame& frame = blocks.frame();
  std::vector<int> times(mesh.triangle_count(), 0);
  ASSERT_EQ(leaves.size(), (mesh.triangle_count() + LeafBlock::lanes - 1) / LeafBlock::lanes);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const LeafBlock& leaf = leaves[i];
    for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
      if (!leaf.is_used(lane)) {
        ASSERT_EQ(i, leaves.size() - 1) << "a leaf that is not full";
        for (int c = 0; c < 3; ++c) {
          for (int axis = 0; axis < 3; ++axis) {
            ASSERT_EQ(leaf.corner[c][axis][lane], leaf.corner[c][axis][0]);
          }
        }
        continue;
      }
      const TriangleId t = leaf.triangle(lane);
      ASSERT_LT(t, mesh.triangle_count());
      ++times[t];
      std::array<std::pair<std::array<double, 3>, int>, 3> corners;
      for (int c = 0; c < 3; ++c) {
        const Vec3 v = mesh.triangle(t)[static_cast<std::size_t>(c)];
        corners[static_cast<std::size_t>(c)] = {{v.x(), v.y(), v.z()}, c};
      }
      std::sort(corners.begin(), corners.end());
      const int inversions = int{corners[0].second > corners[1].second} +
                             int{corners[0].second > corners[2].second} +
                             int{corners[1].second > corners[2].second};
      ASSERT_EQ((leaf.tagged_triangle[lane] & LeafBlock::odd) != 0, inversions % 2 == 1) << t;
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double there = leaf.corner[c][axis][lane];
          const double from_origin = corners[c].first[axis] - frame.origin[static_cast<int>(axis)];
          ASSERT_LE(std::abs(there - from_origin), frame.error);
        }
      }
    }
  }
  EXPECT_EQ(std::count(times.begin(), times.end(), 1), std::ssize(times));
}

/// Fails unless each cylinder contains the triangles of the leaves below it. Appends these leaves.
inline void expect_cylinders_hold(const WideBvh::Tree& index, std::size_t self,
                                  std::vector<std::size_t>& leaves) {
  const NodeBlock& node = index.nodes()[self];
  const CylinderBlock& cylinders = index.cylinders()[self];
  const auto vector_of = [](const float(&from)[3][16], std::size_t lane) {
    return Vec3(from[0][lane], from[1][lane], from[2][lane]);
  };
  for (std::size_t lane = 0; lane < NodeBlock::lanes && node.is_used(lane); ++lane) {
    const std::size_t first = leaves.size();
    if ((node.child[lane] & NodeBlock::leaf_bit) != 0) {
      leaves.push_back(node.child[lane] & ~NodeBlock::leaf_bit);
    } else {
      expect_cylinders_hold(index, node.child[lane], leaves);
    }
    const Vec3 middle = vector_of(cylinders.middle, lane);
    const Vec3 axis = vector_of(cylinders.axis, lane).normalized();
    for (std::size_t i = first; i < leaves.size(); ++i) {
      const LeafBlock& leaf = index.leaves()[leaves[i]];
      for (std::size_t t = 0; t < LeafBlock::lanes; ++t) {
        for (const auto& corner : leaf.corner) {
          const Vec3 way = vector_of(corner, t) - middle;
          const double height = axis.dot(way);
          ASSERT_LE(std::abs(height), cylinders.half_height[lane]) << self << ' ' << lane;
          ASSERT_LE((way - height * axis).stableNorm(), cylinders.radius[lane])
              << self << ' ' << lane;
        }
      }
    }
  }
}

inline void expect_cylinders_hold(const WideBvh::Tree& index) {
  std::vector<std::size_t> leaves;
  expect_cylinders_hold(index, 0, leaves);
  EXPECT_EQ(leaves.size(), index.leaves().size());
}

}  // namespace keepout
