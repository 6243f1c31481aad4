// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

#include "keepout/mesh/mesh.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"

namespace keepout {

/// Remembers that a tip is on the free side of the surface, so that certified steps, which never
/// change sides, keep it there. A tip off the straight way of the last step is placed anew; one
/// that is found on the forbidden side is led out.
class SideWatch {
 public:
  /// Of a tip that no step has led to. Sides are asked about where the motion constraint does.
  SideWatch() = default;

  /// Asks nothing, whatever the motion constraint does: the surface is kept from on whichever side
  /// the tip is.
  static SideWatch off() noexcept {
    SideWatch watch;
    watch.is_on_ = false;
    return watch;
  }

  /// Whether it asks.
  bool is_on() const noexcept { return is_on_; }

  /// Whether it has to be asked on which side of a mesh a tip is: whether no step has led there.
  bool has_to_place(const Vec3& tip, const Mesh& mesh) const noexcept {
    const bool is_free = (tip - free_tip_).norm() <= free_around_ || is_near_way(tip);
    return is_on_ && !(is_free && mesh.id() == mesh_id_);
  }

  /// Notes where a step from the free side of a mesh has led to.
  void after(const Motion& motion, const Step& step, const StepOptions& options,
             const Mesh& mesh) noexcept {
    mesh_id_ = mesh.id();
    free_tip_ = motion.tip + step.motion;
    way_back_ = -step.motion;
    // A margin that is kept leaves more than half of itself free, whatever the tolerance.
    const bool keeps_the_margin = step.ok() && step.status != Status::recovering;
    free_around_ = keeps_the_margin ? 0.5 * distance_kept(options) : 0.0;
  }

  /// Forgets it: the next tip is placed anew.
  void forget() noexcept { free_tip_ = Motion::unset; }

 private:
  /// Returns true if a tip is near the straight way of the last step, which is free as well.
  bool is_near_way(const Vec3& tip) const noexcept {
    const double length2 = way_back_.squaredNorm();
    if (!(length2 > 0.0)) return false;
    const Vec3 off = tip - free_tip_;
    const double share = std::clamp(off.dot(way_back_) / length2, 0.0, 1.0);
    return (off - share * way_back_).norm() <= free_around_;
  }

  bool is_on_ = true;
  Vec3 free_tip_ = Motion::unset;  // where the last step ended; at first nowhere
  Vec3 way_back_ = Vec3::Zero();   // from there to where it began [length]
  double free_around_ = 0.0;       // how far around it all is free as well [length]
  std::uint64_t mesh_id_ = 0;      // of which mesh that is said
};

}  // namespace keepout
