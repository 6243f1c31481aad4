// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "keepout/status.h"
#include "keepout/step/guide.h"

namespace keepout {

/// A body that keeps less than its certified distance from a mesh in a cycle.
struct DegradedClearance {
  int body = -1;             // its number
  int mesh = -1;             // and that of the mesh
  double level = 0.0;        // the fraction of the certified distance that it keeps, below 1
  bool is_certified = true;  // false: nothing is certified for it, and level is 0
};

/// What one cycle may do. Views stay valid until the next step.
struct InstrumentStep {
  Status status = Status::invalid_input;   // how it ended
  std::span<const double> increment = {};  // dq (n); empty unless ok() [rad or length]
  double share = 0.0;    // that is made of the motion that was found; below 1: it was cut short
  int rounds = 0;        // how often a trial motion was judged
  std::size_t rows = 0;  // that hold the motion back, joint limits apart
  std::size_t triangles = 0;  // in reach of one body and one trial motion, at the most
  /// From the body nearest to a mesh, as the cycle began; of bodies no farther off than that mesh's
  /// margin and the band, or slowing_within, and that there was work left to look at. Negative when
  /// the body reaches through the surface. [length]
  std::optional<double> distance = std::nullopt;
  int nearest = -1;       // the number of that body
  int nearest_mesh = -1;  // and of the mesh
  /// The least level of all pairs of body and mesh, 1 if all keep what is certified for them
  /// (InstrumentConstraint: F): below 1 if a mesh approaches faster than a body can retreat; 0 if a
  /// body could not be certified at all, or a mesh moves and there is no motion.
  double level = 1.0;
  /// The pairs of body and mesh that keep less; every other pair keeps what is certified for it.
  std::span<const DegradedClearance> degraded = {};
  std::span<const GuideState> guides = {};   // of each guide, in the order in which they were given
  Relaxation relaxation = Relaxation::none;  // what was relaxed
  /// The causes that kept the motion from being the commanded one. With a motion: all constraints
  /// that limit or shorten it. Without: the constraints for which no motion could be proved.
  /// joints_outside is reported with any status.
  Limits limits = {};

  /// Whether there is a motion that may be carried out; it may be zero.
  bool ok() const noexcept { return is_ok(status); }
  /// One line on what happened and what to do about it; a literal.
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::instrument); }
};

/// How much of a motion is certified.
struct MotionProof {
  /// free: all of it; limited: a part of it; recovering: some body is too close at its start, and
  /// certified is that none comes closer by more than the band. Else why nothing more is known.
  Status status = Status::invalid_input;
  double share = 0.0;  // q + s dq is proven for s from 0 to here, whatever the status: 1 if all is
  std::optional<double> distance = std::nullopt;  // as InstrumentStep::distance [length]

  /// Returns one line on what happened and what to do about it.
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::instrument); }
  /// Whether the instrument keeps the whole margin, less its band, on the whole motion.
  bool is_clear() const noexcept { return status == Status::free && share == 1.0; }
};

}  // namespace keepout
