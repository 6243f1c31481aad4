// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/activation/certified.h"
#include "keepout/solvers/active_set.h"
#include "keepout/step/motion_constraint.h"
#include "keepout/step/side_watch.h"
#include "scene.h"

namespace keepout::app {

/// What is put to the test: it moves a tip, one step at a time.
class Guard {
 public:
  virtual ~Guard() = default;

  /// From here on another tip, under other options.
  virtual void begin(const StepOptions& options, Inside inside) = 0;

  /// Views in the result stay valid until the next step.
  virtual Step step(const Motion& motion) noexcept = 0;
};

/// The certified step, as MotionConstraint makes it, bit for bit; but the options may change
/// without anything being built again.
class CertifiedGuard final : public Guard {
 public:
  /// The scene must outlive the guard.
  explicit CertifiedGuard(const Scene& scene);

  void begin(const StepOptions& options, Inside inside) override;
  Step step(const Motion& motion) noexcept override;

 private:
  const Scene* scene_;
  CertifiedRule rule_;
  ActiveSet solver_;
  Workspace work_;
  StepOptions options_;
  SideWatch sides_;
};

std::unique_ptr<Guard> make_certified_guard(const Scene& scene);

}  // namespace keepout::app
