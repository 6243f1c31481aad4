// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/geometry/twist.h"
#include "keepout/oracle/instrument_oracle.h"
#include "keepout/oracle/judged_guide.h"
#include "keepout/robot/instrument_options.h"
#include "keepout/robot/instrument_step.h"

namespace keepout::oracle {

/// The verdict on one cycle of an instrument.
struct RobotVerdict {
  /// Smallest clearance of all bodies at all poses; infinite beyond the margin. [length]
  double least = std::numeric_limits<double>::infinity();
  /// The smallest of these clearances less what was promised to body and mesh. [length]
  double beyond = std::numeric_limits<double>::infinity();
  /// The smallest distance of a guided point to the edge of what is promised, in tolerances of the
  /// guide; below 0 if the point is beyond the edge.
  double guide_room = std::numeric_limits<double>::infinity();
  bool is_below = false;       // a body came closer than promised, beyond rounding
  bool is_guide_left = false;  // a guide was left by more than is promised, beyond rounding
  bool limits_broken = false;  // a joint left its limits, or moved farther than a cycle admits
};

/// The robot, meshes and guides in the terms of the judge.
struct JudgedScene {
  struct Mesh {
    std::shared_ptr<const TriangleTree> tree;
    double margin = 0.0;  // of its own; 0: that of the options [length]
    Pose pose = {};
  };

  JudgedRobot robot;
  Pose base;  // of link 0
  std::vector<Mesh> meshes;
  std::vector<JudgedGuide> guides = {};
  bool has_band = true;  // the step uses InstrumentOptions::band; MotionConstraint has none
};

/// Follows an instrument and holds each cycle to the theorem: no body comes closer to a mesh than
/// its certified distance. That is margin - band or, if the body was closer already, what it had
/// less the band. It falls only where a step reported that it keeps less. The same holds for
/// guides, whose certified distance is a depth within their region. Kinematics, distances and
/// regions are the oracle's.
///
/// The judge samples a cycle at its start and end, at a random place in each eighth of it, and
/// again around the worst of these. It can miss a dip between two samples: over a flat surface a
/// dip of at most bend / 512, because the height there is a parabola; over an edge or a corner one
/// of half the displacement between two samples. It misses such a dip in one cycle, not in all,
/// because the samples are random.
class RobotJudge {
 public:
  /// `limits`: the chain whose joint limits hold. Limits and random numbers must outlive the judge.
  RobotJudge(JudgedScene scene, const Chain& limits, Random& random,
             std::span<const double> positions, const InstrumentOptions& options, double tolerance);

  /// From now on these options hold.
  void follow(const InstrumentOptions& options);

  /// Sets pose and velocity of a mesh from the next cycle on.
  void place(std::size_t mesh, const Pose& pose, const Twist& velocity);

  /// Judges the motion of all joints at once from where they are to `next`, beside meshes that move
  /// as they were placed. Each body must keep its whole certified distance.
  RobotVerdict judge(std::span<const double> next);
  /// Like judge(next), but bodies must keep only what `step` promises, except for the body
  /// `must_keep`.
  RobotVerdict judge(std::span<const double> next, const InstrumentStep& step,
                     std::optional<std::size_t> must_keep = std::nullopt);

  /// Returns true if no body comes closer than it may and no guide is left when the joints go to
  /// `next` in the coming cycle, with all of the margin but a tenth of the band. Samples nine
  /// poses.
  bool would_allow(std::span<const double> next);

  /// The smallest clearance of each body at the poses of the last cycle; infinite beyond the
  /// margin. [length]
  std::span<const double> least() const noexcept { return least_; }

  /// Returns the oracle of the instrument beside the first mesh. Valid until the next call.
  const InstrumentOracle& oracle() const noexcept { return meshes_.front().oracle; }

  /// Returns the pose of a mesh after the last cycle.
  const Pose& pose(std::size_t mesh) const noexcept { return meshes_[mesh].pose; }

  /// Returns true if no body is closer than margin - band.
  bool is_recovered() const noexcept;

 private:
  /// The distance of a body and a mesh, or of a guide, and the part of it that is promised.
  struct Kept {
    double distance = 0.0;                                    // where the instrument is [length]
    double floor = -std::numeric_limits<double>::infinity();  // promised in the last cycle
    double due = 0.0;                                         // promised in this cycle
    double least = 0.0;                                       // in this cycle
  };
  struct Mesh {
    InstrumentOracle oracle;
    double margin;  // of its own, or 0 [length]
    Pose pose;
    Twist velocity = {};
  };

  double margin(std::size_t mesh) const noexcept;
  double tolerance(std::size_t kept) const noexcept;
  Pose pose_at(const Mesh& mesh, double share) const;
  void measure(std::span<const double> next, double share);
  double measure_and_note(std::span<const double> next, double share);
  void open();
  void sample(std::span<const double> next);
  RobotVerdict judge_promised(std::span<const double> next);

  std::size_t bodies_;
  Pose base_;
  std::vector<Mesh> meshes_;
  std::vector<JudgedGuide> guides_;
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
  std::vector<double> levels_;  // fractions of the certified distances that are promised to pairs
  std::vector<double> least_;   // of the last cycle [length]
};

}  // namespace keepout::oracle
