// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/mesh/mesh.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "keepout/step/side_memory.h"

namespace keepout {

/// Remembers that a tip is on the free side of the surface, where all certified steps keep it. A
/// tip away from the straight path of the last step is classified again. A tip on the forbidden
/// side escapes.
class SideWatch {
 public:
  /// Starts without a last step. The motion constraint determines if the mesh has sides.
  SideWatch() = default;

  /// Returns a watch that never classifies the tip: the tip stays on the side where it is.
  static SideWatch off() noexcept {
    SideWatch watch;
    watch.is_on_ = false;
    return watch;
  }

  /// Returns true if the watch classifies tips.
  bool is_on() const noexcept { return is_on_; }

  /// Returns true if the side of a tip is unknown: no step has moved the tip there. Precondition:
  /// is_on().
  bool must_classify(const Vec3& tip, const Mesh& mesh) const noexcept {
    return !(memory_.is_of(mesh) && memory_.is_near(0, tip, free_around_));
  }

  /// Records the end of a step on the free side of a mesh, for any status: a failed step does not
  /// move the tip.
  void after(const Motion& request, const Step& step, const StepOptions& options,
             const Mesh& mesh) noexcept {
    memory_.note(mesh, 0, request.tip + step.motion, -step.motion);
    // After a step that maintains the clearance, more than half of it is free, for any tolerance.
    const bool keeps_clearance = step.ok() && step.status != Status::recovering;
    free_around_ = keeps_clearance ? 0.5 * required_clearance(options) : 0.0;
  }

  /// Forgets the last step: the next tip is classified again.
  void forget() noexcept { memory_.forget(); }

 private:
  bool is_on_ = true;
  SideMemory<1> memory_;
  double free_around_ = 0.0;  // the distance around the last path that is free as well [length]
};

}  // namespace keepout
