// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "keepout/geometry/twist.h"
#include "keepout/monitor/motion_check.h"
#include "keepout/oracle/instrument_oracle.h"
#include "keepout/oracle/judged_guide.h"
#include "keepout/robot/instrument_options.h"
#include "keepout/robot/instrument_step.h"

namespace keepout::oracle {

/// The verdict on one cycle of an instrument.
struct RobotVerdict {
  /// The smallest clearance of all bodies at the poses that were measured: start and end, and many
  /// more if a body comes closer than promised. Infinite beyond the margin. [length]
  double least = std::numeric_limits<double>::infinity();
  /// The smallest value of a clearance minus the promised clearance of its pair, at these poses.
  /// [length]
  double beyond = std::numeric_limits<double>::infinity();
  /// The smallest value of a guided point's depth in its region minus the promised depth, divided
  /// by the tolerance of the guide, at these poses.
  double guide_room = std::numeric_limits<double>::infinity();
  bool is_below = false;       // a body came closer than promised, beyond rounding
  bool is_guide_left = false;  // a guide was left by more than promised, beyond rounding
  /// Neither proved nor refuted on the whole motion: a clearance or a depth differs from the
  /// promised one by less than rounding.
  bool is_undecided = false;
  bool limits_broken = false;  // a joint left its limits, or moved farther than a cycle allows
};

/// The robot, meshes and guides in the terms of the judge.
struct JudgedScene {
  struct Mesh {
    std::shared_ptr<const TriangleTree> tree;
    double margin = 0.0;  // its own margin; 0: that of the options [length]
    Pose pose = {};
  };

  JudgedRobot robot;
  Pose base;  // of link 0
  std::vector<Mesh> meshes;
  std::vector<JudgedGuide> guides = {};
  bool has_band = true;  // the step uses InstrumentOptions::band; MotionConstraint has none
};

/// Follows an instrument and checks each cycle against the theorem of docs/joint-space-step.md: no
/// body comes closer to a mesh than its certified clearance. The certified clearance is margin -
/// band, or if the body was closer already, its clearance minus the band. It decreases only if a
/// step reported a degraded clearance. Guides are judged in the same way, with the depth in their
/// region as clearance. Kinematics, distances and regions are those of the oracle.
///
/// The verdict covers the whole true motion, with nothing left out between poses: see MotionCheck
/// and check_guide(). If a promise is broken, the judge measures many poses around the worst one,
/// to report by how much.
class RobotJudge {
 public:
  /// `limits`: the chain that has the joint limits. It must outlive the judge.
  RobotJudge(JudgedScene scene, const Chain& limits, std::span<const double> positions,
             const InstrumentOptions& options, double tolerance);

  /// Sets the options from the next cycle on.
  void follow(const InstrumentOptions& options);

  /// Sets pose and velocity of a mesh from the next cycle on.
  void place(std::size_t mesh, const Pose& pose, const Twist& velocity);

  /// Judges the motion of the joints from their positions to `next`, beside meshes that move as
  /// place() states. Each body must maintain its whole certified clearance.
  RobotVerdict judge(std::span<const double> next);
  /// Like judge(next), but bodies must maintain only the clearance that `step` promises. The body
  /// `must_keep` must maintain its whole certified clearance.
  RobotVerdict judge(std::span<const double> next, const InstrumentStep& step,
                     std::optional<std::size_t> must_keep = std::nullopt);

  /// Returns true if the joints may move to `next` in the coming cycle. No body may come closer
  /// than the margin minus a tenth of the band, and no guide may be left by more than a tenth of
  /// its band. A body or a guide that starts beyond this must not get worse. Samples nine poses,
  /// and proves nothing between them: for searches that look for better motions.
  bool would_allow(std::span<const double> next);

  /// Returns the smallest clearance of each body at the measured poses of the last cycle; infinite
  /// beyond the margin. [length]
  std::span<const double> least() const noexcept { return least_; }

  /// Returns the segment from a body's first point to its last one after the last cycle. [length]
  Segment axis(std::size_t body) const;

  /// Returns the pose of a mesh after the last cycle.
  const Pose& pose(std::size_t mesh) const noexcept { return motions_[mesh].pose; }

  /// Returns true if no body is closer than margin - band.
  bool is_recovered() const noexcept;

 private:
  /// The distance of a body from a mesh, or the depth of a guide, and the promised part of it.
  struct Kept {
    double distance = 0.0;                                    // at the present pose [length]
    double floor = -std::numeric_limits<double>::infinity();  // promised in the last cycle
    double due = 0.0;                                         // promised in this cycle
    double least = 0.0;                                       // in this cycle
  };
  struct Mesh {
    InstrumentOracle oracle;
    double margin;  // of its own, or 0 [length]
    Twist velocity = {};
  };

  double margin(std::size_t mesh) const noexcept;
  double tolerance(std::size_t kept) const noexcept;
  void measure(std::span<const double> next, double share);
  void measure_guides(std::span<const double> positions);
  double measure_and_note(std::span<const double> next, double share);
  void open();
  MotionFinding prove(std::span<const double> next);
  void sample(std::span<const double> next, double at);
  void advance(std::span<const double> next);
  RobotVerdict judge_promised(std::span<const double> next);

  std::size_t bodies_;
  Pose base_;
  std::vector<Mesh> meshes_;
  std::vector<MeshMotion> motions_;  // of the meshes in this cycle
  std::vector<JudgedGuide> guides_;
  MotionCheck check_;
  const Chain* limits_;
  std::vector<double> positions_;
  std::vector<double> between_;
  InstrumentOptions options_;
  double tolerance_;
  bool has_band_;
  bool is_placed_anew_ = false;
  std::vector<Kept> kept_;  // the pairs in the order of InstrumentConstraint, then the guides
  std::vector<double> distances_;
  std::vector<double> due_;     // of the pairs, less rounding [length]
  std::vector<double> levels_;  // the clearance fractions that are promised to pairs
  std::vector<double> least_;   // of the last cycle [length]
};

}  // namespace keepout::oracle
