// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/step/step.h"

namespace keepout {

/// Watches that a tip is on the free side before a certified step keeps it there. A tip that the
/// last step did not lead to is placed anew; one that is found on the forbidden side is led out.
class SideWatch {
 public:
  /// Asks nothing: the surface is kept from on whichever side the tip is.
  SideWatch() = default;

  /// Precondition: the mesh that is asked about is watertight.
  static SideWatch of_watertight() noexcept;

  /// The step of a tip on the forbidden side, in place of the one asked for; nothing for a tip on
  /// the free side. `inside` and zero motion when it is deeper than options.deepest, and with a
  /// Jacobian or rows, as there is no straight way out. Precondition: check(motion, options) is ok.
  std::optional<Step> before(const Mesh& mesh, const SpatialIndex& index, const Motion& motion,
                             const StepOptions& options, Workspace& work) const noexcept;

  /// The step of a tip that touches the surface, so that the rule cannot tell its side: a short way
  /// to a place that is found to be free. Nothing where none is found, or none may be made.
  std::optional<Step> off_surface(const Mesh& mesh, const SpatialIndex& index, const Motion& motion,
                                  const StepOptions& options, Workspace& work) const noexcept;

  /// Takes down where a certified step from the free side has led to.
  void after(const Motion& motion, const Step& step, const StepOptions& options) noexcept;

  /// Forgets it: the next tip is placed anew.
  void forget() noexcept;

 private:
  bool is_on_ = false;
  Vec3 free_tip_ = Motion::unset;  // where the last step ended; at first nowhere
  double free_around_ = 0.0;       // how far around it all is free as well [length]
};

/// One control cycle of a tip that is watched: step, or the way out.
template <ActivationRule A, QpSolver S, StageObserver O = Unobserved>
Step step(SideWatch& sides, const Mesh& mesh, const SpatialIndex& index, A& activation, S& solver,
          const Motion& motion, const StepOptions& options, Workspace& work,
          O&& observer = {}) noexcept {
  // What is refused says nothing of where the tip is.
  const Status checked = check(motion, options);
  if (!is_ok(checked)) return {.status = checked};
  if (const auto out = sides.before(mesh, index, motion, options, work)) return *out;
  const Step result = step_as_checked(mesh, index, activation, solver, motion, options, work,
                                      std::forward<O>(observer));
  if (result.status == Status::touching) {
    if (const auto off = sides.off_surface(mesh, index, motion, options, work)) return *off;
  }
  sides.after(motion, result, options);
  return result;
}

}  // namespace keepout
