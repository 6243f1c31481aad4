// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "keepout/monitor/hull.h"
#include "keepout/monitor/judged_robot.h"
#include "keepout/monitor/triangle_tree.h"
#include "keepout/oracle/distance.h"

namespace keepout::oracle {

/// Measures the clearance of an instrument's bodies from a mesh, independently of the library:
/// kinematics, distances and search are its own.
///
/// It is fast if an instrument moves a little at a time: each body remembers the triangles that
/// were near, and its displacement since then. Results do not depend on this memory. Use one oracle
/// for each thread.
class InstrumentOracle {
 public:
  /// `base`: the pose of link 0. Throws std::invalid_argument for a body without points or with
  /// more than Hull::most_points.
  InstrumentOracle(std::shared_ptr<const TriangleTree> tree, JudgedRobot robot, const Pose& base);

  const JudgedRobot& robot() const noexcept { return robot_; }
  std::size_t bodies() const noexcept { return robot_.bodies.size(); }

  /// Moves the joints to `positions` [rad or length].
  void move_to(std::span<const double> positions);
  /// Like move_to(positions), but also moves link 0 to `base`, in the frame of the mesh: for a mesh
  /// that moves.
  void move_to(std::span<const double> positions, const Pose& base);

  /// Returns the frames of the links at these positions, the base first, in the frame of the mesh.
  std::span<const LinkFrame> links() const noexcept { return links_; }

  /// Returns the segment from a body's first point to its last one: the axis of a capsule. [length]
  Segment axis(std::size_t body) const noexcept {
    return {cores_[body].points().front(), cores_[body].points().back()};
  }

  /// Returns the distance of the body's surface from the mesh, accurate to 1e-9 of the distance of
  /// its core plus about 1e-12 of the coordinates. It is below 0 if the mesh reaches into the body,
  /// and minus the radius only if the core touches the mesh. Infinite if it is more than `reach`.
  /// [length]
  double clearance(std::size_t body, double reach);
  /// Returns the smallest clearance of all bodies.
  double clearance(double reach) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t b = 0; b < bodies(); ++b) least = std::min(least, clearance(b, reach));
    return least;
  }

 private:
  struct Neighbor {
    Triangle triangle;
    Vec3 center;
    double radius;  // of a ball around the triangle
  };
  /// A neighbor and its key: a lower bound of its distance, plus the path length of the body when
  /// the bound was computed. So the key needs no update while the body moves on.
  struct Entry {
    double key;
    std::uint32_t neighbor;
  };
  /// The triangles near a body, and its path length since they were fetched.
  struct Surroundings {
    double known = -1.0;  // all triangles that were nearer are in `neighbors`
    double slack = 1.0;   // added to the requested distance
    double travelled = 0.0;
    std::vector<Vec3> last = {};  // the points of its core at the last call
    std::vector<Neighbor> neighbors = {};
    std::vector<Entry> heap = {};  // the least key first
  };

  void look_around(Surroundings& around, const Hull& core, double reach);

  std::shared_ptr<const TriangleTree> tree_;
  JudgedRobot robot_;
  Pose base_;
  std::vector<LinkFrame> links_;
  std::vector<Hull> cores_;
  std::vector<Surroundings> surroundings_;
  std::vector<TriangleId> found_;
};

}  // namespace keepout::oracle
