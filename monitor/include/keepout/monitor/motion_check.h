// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "keepout/geometry/twist.h"
#include "keepout/monitor/hull.h"
#include "keepout/monitor/judged_robot.h"
#include "keepout/monitor/travel.h"
#include "keepout/monitor/triangle_tree.h"

namespace keepout::monitor {

/// The motion of a mesh in a cycle: its pose at the start, and its displacement.
struct MeshMotion {
  Pose pose;
  Twist way = {};  // in the axes of the world [length, rad]

  /// Returns the pose at the fraction s of the motion.
  Pose at(double s) const noexcept;
};

/// The motion of an instrument and of meshes in a cycle. The joints are on the straight line from
/// `from` to `to`.
struct InstrumentMotion {
  std::span<const double> from, to;    // positions of the joints [rad or length]
  std::span<const MeshMotion> meshes;  // one for each mesh
};

enum class Clearance : std::uint8_t {
  kept,      // proved at each time of the motion
  lost,      // a pose is closer
  undecided  // the work ended, or the clearance differs from the due one by less than rounding
};

struct MotionFinding {
  Clearance clearance = Clearance::kept;
  std::size_t pair = 0;  // that lost its clearance, or is undecided
  double at = 0.0;       // fraction of the motion at which it is closer
};

/// Decides whether the bodies of an instrument maintain their clearance from meshes on the whole
/// true motion, with nothing left out between poses. Shares no code with the steps.
///
/// Let P and M bound speed and second derivative of all points of a body, in the frame of the mesh
/// (travel()). A triangle is clear of the body in a part of the motion of the length w
///
/// - if the mean of its distances at both ends, less P w / 2, is the due distance;
///
/// - or if for one direction the heights of all points of the core over the triangle are the due
///   distance at least. Between the ends of the part, a height is on or above least_between() of
///   its values at the ends, with the second derivative M w^2.
///
/// Otherwise the part is halved. If the body is closer at the middle, its clearance is lost. A part
/// of the length 2^-20 that is still not clear is undecided.
class MotionCheck {
 public:
  static constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();
  static constexpr int levels = 20;  // of halving

  /// `trees`: of the meshes. `base`: the pose of link 0. `most_triangles`: near a body; if there
  /// may be more, a check is undecided. With a limit, all memory is allocated here, and checks
  /// allocate nothing. Throws std::invalid_argument for a body without points or with more than
  /// Hull::most_points.
  MotionCheck(std::span<const std::shared_ptr<const TriangleTree>> trees, const JudgedRobot& robot,
              const Pose& base, std::uint64_t most_triangles = unlimited);

  /// Decides if each pair keeps its due clearance: the distance of the body's surface. Pairs are
  /// numbered mesh by mesh. A pair that is due -infinity is not examined. Stops at the first pair
  /// that loses its clearance. Takes at most `work` units, each about the time of one distance.
  /// Trusts positions and poses to be exact: a due clearance must be lower by their rounding.
  /// [length]
  MotionFinding check(const InstrumentMotion& motion, std::span<const double> due,
                      std::uint64_t work = unlimited);

  enum class End : std::uint8_t { start, end };
  /// Returns the distance of a pair's core from the mesh at an end of the last motion; infinite if
  /// it is more than `reach`. Empty if the work of the last check ends. Precondition: the last
  /// motion was finite. [length]
  std::optional<Bracket> core_distance(End end, std::size_t pair, double reach);

  /// Returns the number of poses of the last check, its ends included.
  std::size_t poses() const noexcept { return poses_; }

 private:
  static constexpr int of_a_level = 4;  // poses of a level that are remembered
  static constexpr std::size_t at_start = 0, at_end = 1;

  /// The instrument at one time of the motion. [length]
  struct PoseAt {
    double s = -1.0;
    std::vector<Vec3> points = {};       // of all bodies, in the world
    std::vector<LinkFrame> links = {};   // in the world
    std::vector<Hull> cores = {};        // of each pair, in the frame of the mesh
    std::vector<JointLine> joints = {};  // of the turn and the way of the mesh, then of the robot
  };
  struct Neighbor {
    Triangle triangle;
    Vec3 center;
    double radius;  // of a ball around the triangle
    double low;     // least distance when it was fetched
  };
  /// The triangles near a core, in the order of their distance when they were fetched.
  struct Surroundings {
    double known = -1.0;            // all triangles that were nearer are in `neighbors`
    double slack = 1.0;             // added to the requested distance [sizes of triangles]
    double shift = 0.0;             // largest displacement of the core since then
    std::vector<Vec3> points = {};  // of the core when they were fetched
    std::vector<Neighbor> neighbors = {};
    std::size_t nearest = 0;        // at the end of the last motion
    Vec3 direction = Vec3::Zero();  // that separated a triangle last
  };
  /// A part of the motion, and the poses at its ends.
  struct Part {
    double from, to;
    std::size_t first, last;
  };
  /// A pair, its due distance and the bounds of its motion.
  struct Pair {
    std::size_t number;
    double due;                     // of the core [length]
    double speed;                   // P [length]
    double rounding;                // [length]
    std::span<const double> bends;  // M of each point of the core [length]
  };

  void place_links(PoseAt& slot, double s);
  void place_cores(PoseAt& slot, double s);
  void place_joints();
  void place_mesh(const MeshMotion& mesh);
  std::size_t middle_of(const Part& part, int level);
  const Hull& core(std::size_t slot, const Pair& pair) const noexcept;
  double bound_motion(std::size_t body);
  bool surround(Surroundings& around, const Hull& core, double reach);
  Clearance check_pair(std::size_t number, double due);
  Clearance check_triangle(const Pair& pair, const Triangle& triangle, const Part& part,
                           const Gap& first, const Gap& last, int level);
  bool separates(const Pair& pair, const Triangle& triangle, const Part& part,
                 const Vec3& direction);
  bool spend(std::uint64_t units) noexcept;

  std::vector<std::shared_ptr<const TriangleTree>> trees_;
  JudgedRobot robot_;
  Pose base_;
  std::vector<std::size_t> first_point_;    // of each body, and the number of all points
  std::vector<Surroundings> surroundings_;  // of each pair
  std::vector<PoseAt> slots_;
  std::vector<double> positions_;
  std::vector<double> end_;    // of the last motion
  std::vector<double> bends_;  // M of all points of bodies
  std::vector<TriangleId> found_;
  std::uint64_t most_triangles_;
  InstrumentMotion motion_ = {};
  std::uint64_t work_ = 0;   // left
  std::uint64_t spare_ = 0;  // of the search with slack for a pair
  std::size_t poses_ = 0;
  double lost_at_ = 0.0;
};

}  // namespace keepout::monitor
