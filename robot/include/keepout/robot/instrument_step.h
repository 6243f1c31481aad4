// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "keepout/status.h"
#include "keepout/step/guide.h"

namespace keepout {

/// A body that maintains less than its certified clearance from a mesh in a cycle.
struct DegradedClearance {
  int body = -1;  // the number of the body
  int mesh = -1;  // the number of the mesh
  /// The fraction of the certified clearance that the body maintains, below 1.
  double fraction = 0.0;
  bool is_certified = true;  // false: no clearance is certified, and the fraction is 0
};

/// The result of a cycle. Views stay valid until the next step.
struct InstrumentStep {
  Status status = Status::invalid_input;   // the outcome of the cycle
  std::span<const double> increment = {};  // dq (n); empty unless ok() [rad or length]
  /// `increment` as a fraction of the motion that the solver found. With status truncated, the
  /// solver may have solved for a part of the command only. Then 1 means the whole part.
  double fraction = 0.0;
  double share = 0.0;         // deprecated: use fraction
  int rounds = 0;             // number of trial motions that were solved and judged
  std::size_t rows = 0;       // constraints that limit the motion, without joint limits
  std::size_t triangles = 0;  // largest number near one body in one trial motion
  /// The distance of the nearest body from a mesh at the start of the cycle; below 0 if the body
  /// intersects the surface. Empty if no body is within margin + max(band, slowing_within), or if
  /// the work budget ended first. [length]
  std::optional<double> distance = std::nullopt;
  int nearest = -1;       // the number of that body
  int nearest_mesh = -1;  // the number of the mesh
  /// The least clearance fraction of all pairs of a body and a mesh. It is 1 if each pair maintains
  /// its certified clearance (InstrumentConstraint: F), and below 1 if a mesh approaches faster
  /// than a body can retreat. It is 0 if no clearance could be certified for a body, or if a mesh
  /// moves and there is no motion. It is meaningless if there is no motion and no mesh moves.
  double clearance_fraction = 1.0;
  double level = 1.0;  // deprecated: use clearance_fraction
  /// The pairs of a body and a mesh whose clearance fraction is below 1; empty if the cycle did not
  /// start.
  std::span<const DegradedClearance> degraded = {};
  std::span<const GuideState> guides = {};   // the state of each guide, in the order given
  Relaxation relaxation = Relaxation::none;  // the constraints that were relaxed
  /// The limits that make the motion differ from the commanded one. With a motion, these are all
  /// constraints that limit or shorten it. A budget or capacity that ends only a refinement is not
  /// one of them.
  /// Without a motion, these are the causes why no motion could be proved.
  /// joints_outside is reported with any status, singularity only without another limit.
  Limits limits = {};

  /// Returns true if the increment may be executed; it may be zero.
  bool ok() const noexcept { return is_ok(status); }
  /// Returns one line on what happened and what to do about it. For a free motion, it also reports
  /// a joint that starts outside its position limits.
  std::string_view reason() const noexcept;
};

/// The part of a motion that is proved clear.
struct MotionProof {
  /// free: the whole motion is proved. limited: a part of it. recovering: a body is too close at
  /// the start, and no body comes closer by more than the band. Any other status is the cause of
  /// the end of the proof.
  Status status = Status::invalid_input;
  /// The motion q + s dq is proved for s in [0, fraction], with any status.
  double fraction = 0.0;
  double share = 0.0;                             // deprecated: use fraction
  std::optional<double> distance = std::nullopt;  // as InstrumentStep::distance [length]

  /// Returns one line on what happened and what to do about it.
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::instrument); }
  /// Returns true if each body stays at least margin - band away on all of the motion.
  bool is_clear() const noexcept { return status == Status::free && fraction == 1.0; }
};

}  // namespace keepout
