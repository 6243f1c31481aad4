// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/geometry/shapes.h"
#include "keepout/mesh/mesh.h"
#include "keepout/step/options.h"

namespace keepout {

/// The interface of a monitor: a checker that is independent of the step, and confirms each motion
/// before it is returned. keepout::monitor has one. See MotionConstraint::set_monitor.
class TipMonitor {
 public:
  virtual ~TipMonitor() = default;

  /// Returns true if the tip, on the whole straight motion, stays as far from the mesh as
  /// min(required clearance, its distance at `from`), less a few tolerances. Returns false if it
  /// comes closer, and if the monitor cannot decide. Must not allocate, lock, throw or print.
  virtual bool confirms(const Vec3& from, const Vec3& to, const StepOptions& options) noexcept = 0;

  /// Continues with a mesh that has moved. May allocate. If this throws, the monitor must not
  /// confirm any further motion, or must still confirm motions beside the former mesh.
  virtual void follow(std::shared_ptr<const Mesh> mesh) = 0;
};

}  // namespace keepout
