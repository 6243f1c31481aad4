// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "keepout/geometry/pose.h"
#include "keepout/geometry/twist.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// The motion of an instrument and of all meshes in a cycle, and the clearances that the step
/// states. A pair is a body and a mesh; pairs are numbered mesh by mesh.
struct MonitoredMotion {
  /// A mesh: its pose at the start, and its displacement [length, rad].
  struct OfMesh {
    Pose pose = {};  // at the start
    Twist way = {};  // displacement in the cycle
  };
  /// A pair. [length]
  struct OfPair {
    double certified = 0.0;  // of the body; -infinity without a certified clearance
    /// Margin - band. A body that starts at this clearance, or is not far below, must be certified
    /// accordingly; -infinity for a degraded pair.
    double target = 0.0;
    double band = 0.0;  // see InstrumentOptions::band
  };

  std::span<const double> from;    // positions of the joints at the start [rad or length]
  std::span<const double> to;      // and at the end
  std::span<const OfMesh> meshes;  // in the order of InstrumentConstraint::add_mesh
  std::span<const OfPair> pairs;   // mesh by mesh
  double tolerance = 0.0;          // see InstrumentConstraint::tolerance [length]
};

/// The interface of a monitor: a checker that is independent of the step, and confirms each motion
/// before it is returned. keepout::monitor has one. See InstrumentConstraint::set_monitor.
class InstrumentMonitor {
 public:
  virtual ~InstrumentMonitor() = default;

  /// Returns true if each body maintains its certified clearance, less a few tolerances, on the
  /// whole true motion. This clearance must not be less than the distance at the start demands.
  /// Returns false otherwise, and if the monitor cannot decide. Must not allocate, lock, throw or
  /// print.
  virtual bool confirms(const MonitoredMotion& motion) noexcept = 0;

  /// Replaces the mesh with this number, or adds it if it is one beyond the last. May allocate. If
  /// this throws, the monitor must be as before.
  virtual void follow(std::shared_ptr<const Mesh> mesh, std::size_t number) = 0;
};

}  // namespace keepout
