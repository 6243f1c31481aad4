// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "keepout/activation/activation.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "keepout/step/solver.h"
#include "keepout/step/workspace.h"

namespace keepout::app {

/// A rule as it is measured.
struct RuleSetting {
  std::string activation;
  std::optional<double> radius;  // of the motion sphere; none: as far as motions lead [mm]
  double margin = 0.0;           // that certified keeps; the paper's rules take the tip as is [mm]

  /// Whether a motion is accepted for its proof, and not because a solver says that it is the best.
  bool proves_motions() const { return activation == "certified"; }
};

/// The certified rule looks only where the motion leads, within 5 mm.
StepOptions options_of(const RuleSetting& setting);

/// Where the rule looks for triangles at first when it is asked for the motion.
Ball ball_of(const RuleSetting& setting, const Activation& rule, const Motion& motion);

/// What a step came to.
struct Answer {
  Status status = Status::invalid_input;
  Vec3 motion = Vec3::Zero();

  bool operator==(const Answer&) const = default;
};

/// All that a step needs, put together by hand, the rule in the form that is given; views only.
struct Pipeline {
  const Mesh& mesh;
  const SpatialIndex& index;
  Activation& rule;
  Solver& solver;
  Workspace& work;
  const RuleSetting& setting;

  Answer ask(const Motion& motion) const;
};

}  // namespace keepout::app
