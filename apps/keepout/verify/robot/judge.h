// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/oracle/instrument_oracle.h"
#include "keepout/oracle/judged_guide.h"
#include "keepout/robot/instrument_constraint.h"

namespace keepout::app {

/// What the judge says of one cycle.
struct RobotVerdict {
  /// Smallest clearance of all bodies at all poses; infinite beyond the margin. [length]
  double least = std::numeric_limits<double>::infinity();
  /// The smallest of these clearances less what was promised to body and mesh. [length]
  double beyond = std::numeric_limits<double>::infinity();
  /// The smallest room that a guide had left, to the edge of what is promised: below 0 it was left.
  /// In tolerances of the guide.
  double guide_room = std::numeric_limits<double>::infinity();
  bool is_below = false;       // some body did not keep it, beyond rounding
  bool is_guide_left = false;  // some guide was left by more than is promised, beyond rounding
  bool limits_broken = false;  // a joint left its limits, or went farther than a cycle admits
};

/// The robot, meshes and guides in the terms of the judge.
struct JudgedScene {
  struct Mesh {
    std::shared_ptr<const oracle::TriangleTree> tree;
    double margin = 0.0;  // of its own; 0: that of the options [length]
    Pose pose = {};
  };

  oracle::JudgedRobot robot;
  Pose base;  // of link 0
  std::vector<Mesh> meshes;
  std::vector<oracle::JudgedGuide> guides = {};
  bool has_band = true;  // InstrumentOptions::band is allowed for: MotionConstraint has none
};

/// Follows an instrument and holds each cycle to the theorem: no body comes closer to a mesh than
/// its floor, which is margin - band, or when it was closer already, what it had, less the band;
/// and which falls only where a step said that it could keep less. The same holds for guides, of
/// which the floor is a depth within their region. Kinematics, distances and regions are the
/// oracle's.
///
/// A cycle is looked at where it begins and ends, at a random place in each eighth of it, and again
/// around the worst of these. Between such places a dip can be missed: over a flat surface one of
/// bend / 512 at most, as the height there is a parabola's; over an edge or a corner one of half
/// the way between two places. Such a dip is missed in one cycle, not in all: the places are
/// random.
class RobotJudge {
 public:
  /// `limits`: whose limits of joints hold. Limits and random numbers must outlive the judge.
  RobotJudge(JudgedScene scene, const Chain& limits, Random& random,
             std::span<const double> positions, const InstrumentOptions& options, double tolerance);

  /// From now on these options hold.
  void follow(const InstrumentOptions& options);

  /// From the next cycle on, this is where a mesh is and how it moves.
  void place(std::size_t mesh, const Pose& pose, const Twist& velocity);

  /// The joints go from where they are to `next`, all at once, and meshes as they were placed.
  /// `levels`: the shares of the floors that are promised to all bodies beside the first mesh, the
  /// second, and so on; without them all of it.
  RobotVerdict judge(std::span<const double> next, std::span<const double> levels = {});

  /// Returns true if no body comes closer than it may and no guide is left when the joints go to
  /// `next` in the coming cycle; with all of the margin but a tenth of the band. Looks at nine
  /// poses.
  bool would_allow(std::span<const double> next);

  /// The smallest clearance of each body at the poses of the last cycle; infinite beyond the
  /// margin. [length]
  std::span<const double> least() const noexcept { return least_; }

  /// Returns the oracle of the instrument beside the first mesh. Valid until the next call.
  const oracle::InstrumentOracle& oracle() const noexcept { return meshes_.front().oracle; }

  /// Returns the pose of a mesh after the last cycle.
  const Pose& pose(std::size_t mesh) const noexcept { return meshes_[mesh].pose; }

  /// Returns true if no body is closer than margin - band.
  bool is_recovered() const noexcept;

 private:
  /// Body and mesh, or a guide: a distance, and what of it is promised.
  struct Kept {
    double distance = 0.0;                                    // where the instrument is [length]
    double floor = -std::numeric_limits<double>::infinity();  // promised in the last cycle
    double due = 0.0;                                         // promised in this cycle
    double least = 0.0;                                       // in this cycle
  };
  struct Mesh {
    oracle::InstrumentOracle oracle;
    double margin;  // of its own, or 0 [length]
    Pose pose;
    Twist velocity = {};
  };

  double margin(std::size_t mesh) const noexcept;
  double tolerance(std::size_t kept) const noexcept;
  Pose pose_at(const Mesh& mesh, double share) const;
  void look(std::span<const double> next, double share, std::span<double> distances);
  double look_and_note(std::span<const double> next, double share);
  void open(std::span<const double> levels);

  std::size_t bodies_;
  Pose base_;
  std::vector<Mesh> meshes_;
  std::vector<oracle::JudgedGuide> guides_;
  const Chain* limits_;
  Random* random_;
  std::vector<double> positions_;
  std::vector<double> between_;
  InstrumentOptions options_;
  double tolerance_;
  bool has_band_;
  bool is_placed_anew_ = false;
  std::vector<Kept> kept_;  // pairs as InstrumentConstraint has them, then guides
  std::vector<double> distances_;
  std::vector<double> least_;  // of the last cycle [length]
};

}  // namespace keepout::app
