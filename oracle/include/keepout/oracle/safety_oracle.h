// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "keepout/oracle/inside_test.h"
#include "keepout/oracle/triangle_tree.h"

namespace keepout::oracle {

/// The triangles around a moving place, side by side in memory: a tip that moves a little at a time
/// rarely needs the tree. For one thread; it allocates when it fetches.
class Neighborhood {
 public:
  struct Neighbor {
    Bounds bounds;
    Triangle triangle;
    TriangleId id;
  };
  /// Some that are near each other, passed over at once where their bounds are out of the way.
  struct Group {
    Bounds bounds;
    std::span<const Neighbor> neighbors;
  };

  explicit Neighborhood(std::shared_ptr<const TriangleTree> tree);

  /// At least each triangle whose bounds overlap the box, once. The order of any two of them is
  /// always the same. Valid until the next call.
  std::span<const Group> around(const Bounds& box) {
    if (!region_.contains(box)) fetch(box);
    return groups_;
  }

 private:
  void fetch(const Bounds& box);

  std::shared_ptr<const TriangleTree> tree_;
  Bounds region_;        // neighbors_ are all that overlap it
  double margin_ = 4.0;  // of the region around the box, in sizes of the box
  std::vector<TriangleId> found_;
  std::vector<Neighbor> neighbors_;  // in the order of the tree, so those close by are near
  std::vector<Group> groups_;
};

/// What became of a way.
struct Finding {
  bool crosses = false;  // it touches the mesh: their distance is exactly 0
  bool below = false;    // its distance from the mesh is less than the threshold, exactly
  double distance =
      std::numeric_limits<double>::infinity();  // [length]; infinite: beyond the reach
  TriangleId triangle = no_triangle;            // the nearest; of equally near ones the lowest id
};

/// Judges the ways of a tool tip past a mesh, and believes nothing that the engine computes: it
/// takes the mesh as data and has a geometry, a search and an arithmetic of its own.
///
/// `crosses` and `below` are right for the real numbers that the doubles stand for, on every
/// mesh: open, degenerate, self-intersecting, far from the origin. `distance` is within 1e-9 of
/// itself, and agrees with the two: it is 0 if and only if the way crosses, <= the threshold when
/// below, and >= the threshold when not.
///
/// The answers do not depend on what was asked before; the time does. A way near the last one takes
/// a microsecond or two in contact with a mesh of a million triangles, less in free space. One that
/// takes exact arithmetic - some 2^-47 of the size of a triangle in reach around the threshold, or
/// all but a touch - takes some 10 us for each such triangle.
///
/// One oracle a thread. Copies are cheap: they share what was built.
class SafetyOracle {
 public:
  /// O(n log n): about 2 s for a million triangles.
  explicit SafetyOracle(std::shared_ptr<const Mesh> mesh);

  /// Judges the closed segment from `from` to `to`, which may coincide. The distance is told when
  /// it is at most `reach`, or the threshold if that is more. Throws std::invalid_argument unless
  /// all are finite and the threshold is >= 0.
  Finding check(const Vec3& from, const Vec3& to, double threshold, double reach = 0.0);

  /// The distance of a point from the mesh [length], within 1e-9 of itself, and 0 if and only if
  /// the point is on the mesh. O(log n) where the mesh is not everywhere as near. Precondition:
  /// finite coordinates.
  double distance(const Vec3& point) const;

  /// The tree of the mesh's triangles, for other judges of the same mesh.
  const std::shared_ptr<const TriangleTree>& tree() const noexcept { return tree_; }

  /// Strictly inside a closed mesh, exactly, whatever the winding; nothing when an edge of the mesh
  /// has an odd number of triangles. Some 10 us to 100 us.
  std::optional<bool> inside(const Vec3& point) const { return inside_test_->inside(point); }

 private:
  /// No triangle is nearer to the center than the radius.
  struct ClearBall {
    Vec3 center = Vec3::Zero();
    double radius = 0.0;
  };

  bool is_clear(const Segment& segment, double reach) const noexcept;

  std::shared_ptr<const TriangleTree> tree_;
  std::shared_ptr<const InsideTest> inside_test_;
  Neighborhood neighborhood_;
  ClearBall clear_ball_;
  std::vector<const Neighborhood::Neighbor*> undecided_;
};

}  // namespace keepout::oracle
