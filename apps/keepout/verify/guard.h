// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/step/motion_constraint.h"
#include "scene.h"

namespace keepout::app {

/// What is put to the test: the motion constraint that users get, on one tip after the other. Tests
/// put worse ones in its place.
class Guard {
 public:
  /// The scene must outlive the guard.
  explicit Guard(const Scene& scene);
  virtual ~Guard() = default;

  /// From here on another tip, under other options.
  virtual void begin(const StepOptions& options, Inside inside);

  /// Views in the result stay valid until the next step.
  virtual Step step(const Motion& motion) noexcept;

 private:
  MotionConstraint constraint_;
  SideWatch sides_;
};

}  // namespace keepout::app
