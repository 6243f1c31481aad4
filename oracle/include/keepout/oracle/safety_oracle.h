// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "keepout/monitor/triangle_tree.h"
#include "keepout/oracle/inside_test.h"

namespace keepout::oracle {

/// The triangles around a moving point, stored contiguously: a tip that moves a little at a time
/// rarely needs the tree. For one thread; allocates when it fetches.
class Neighborhood {
 public:
  struct Neighbor {
    Bounds bounds;
    Triangle triangle;
    TriangleId id;
  };
  /// Neighbors that are near each other; their common bounds exclude all of them at once.
  struct Group {
    Bounds bounds;
    std::span<const Neighbor> neighbors;
  };

  explicit Neighborhood(std::shared_ptr<const TriangleTree> tree);

  /// Returns each triangle whose bounds overlap the box once, and perhaps others. The order of any
  /// two triangles is always the same. Valid until the next call.
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

/// The result for one segment.
struct Finding {
  bool crosses = false;  // it touches the mesh: the distance is exactly 0
  bool below = false;    // its distance from the mesh is less than the threshold, exactly
  double distance =
      std::numeric_limits<double>::infinity();  // [length]; infinite: beyond the reach
  TriangleId triangle = no_triangle;  // the nearest; if several are equally near, the lowest id
};

/// Judges the motions of a tool tip near a mesh, independently of the engine: it takes the mesh as
/// data, and its geometry, search and arithmetic are its own.
///
/// `crosses` and `below` are exact for the real numbers that the doubles represent, on every mesh:
/// open, degenerate, self-intersecting, far from the origin. `distance` has a relative error of at
/// most 1e-9 and agrees with both. It is 0 if and only if the segment crosses. It is <= the
/// threshold if `below`, else >= the threshold.
///
/// Results do not depend on earlier calls; the time does. A segment near the last one takes 1 to 2
/// µs in contact with a mesh of a million triangles, and less in free space. Exact arithmetic takes
/// about 10 µs for each triangle that needs it. These triangles almost touch, or their distance
/// differs from the threshold by less than about 2^-47 of their size.
///
/// Use one oracle for each thread. Copies are cheap: they share the tree.
class SafetyOracle {
 public:
  /// Builds the tree in O(n log n): about 2 s for a million triangles.
  explicit SafetyOracle(std::shared_ptr<const Mesh> mesh);

  /// Judges the closed segment from `from` to `to`, which may coincide. Returns the distance if it
  /// is at most `reach` and threshold, whichever is larger. Throws std::invalid_argument unless all
  /// numbers are finite and the threshold is >= 0.
  Finding check(const Vec3& from, const Vec3& to, double threshold, double reach = 0.0);

  /// Returns the distance of a point from the mesh [length], with a relative error of at most 1e-9.
  /// It is 0 if and only if the point is on the mesh. O(log n), unless many triangles are equally
  /// near. Precondition: finite coordinates.
  double distance(const Vec3& point) const;

  /// Returns the tree of the mesh's triangles, for other judges of the same mesh.
  const std::shared_ptr<const TriangleTree>& tree() const noexcept { return tree_; }

  /// Returns true if the point is strictly inside the closed mesh: exact, for any winding. Empty if
  /// an edge of the mesh has an odd number of triangles. Takes about 10 µs to 100 µs.
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
