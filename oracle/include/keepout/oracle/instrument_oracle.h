// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "keepout/oracle/hull.h"
#include "keepout/oracle/judged_robot.h"
#include "keepout/oracle/triangle_tree.h"

namespace keepout::oracle {

/// Judges where the bodies of an instrument are beside a mesh, and believes nothing that the
/// library computes: kinematics, distances and search are its own.
///
/// One that moves a little at a time is followed cheaply: each body remembers the triangles that
/// were near, and how far it has gone since. The answers do not depend on it. One oracle a thread.
class InstrumentOracle {
 public:
  /// `base`: the pose of link 0. Throws std::invalid_argument for a body without points or with
  /// more than Hull::most_points.
  InstrumentOracle(std::shared_ptr<const TriangleTree> tree, JudgedRobot robot, const Pose& base);

  const JudgedRobot& robot() const noexcept { return robot_; }
  std::size_t bodies() const noexcept { return robot_.bodies.size(); }

  /// From now on the joints are at `positions` [rad or length].
  void move_to(std::span<const double> positions);
  /// Like move_to(positions), but also moves link 0 to `base`, as the mesh sees it: for a mesh that
  /// moves.
  void move_to(std::span<const double> positions, const Pose& base);

  /// The frames of the links at these positions, the base first, as the mesh sees them.
  std::span<const LinkFrame> links() const noexcept { return links_; }

  /// The segment from a body's first point to its last one: the axis of a capsule. [length]
  Segment axis(std::size_t body) const noexcept {
    return {cores_[body].points().front(), cores_[body].points().back()};
  }

  /// The distance of the surface of the body from the mesh, to 1e-9 of the distance of its core and
  /// some 1e-12 of the coordinates; less than 0 when the mesh reaches into it, and minus its radius
  /// only where its core touches. Infinite when that is more than `reach`. [length]
  double clearance(std::size_t body, double reach);
  /// The smallest clearance of all bodies.
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
  /// A neighbor, and how far away it is at least, plus how far the body had travelled when that
  /// was found out: the sum need not be kept up to date while the body travels on.
  struct Entry {
    double key;
    std::uint32_t neighbor;
  };
  /// What was around a body, and how far it has travelled since.
  struct Surroundings {
    double known = -1.0;  // all triangles that were nearer than that are here
    double slack = 1.0;   // beyond what was asked for
    double travelled = 0.0;
    std::vector<Vec3> last = {};  // the points of its core at the last call
    std::vector<Neighbor> neighbors = {};
    std::vector<Entry> heap = {};  // those that may be nearest first
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
