// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/pipeline.h"

#include "keepout/step/step.h"

namespace keepout::app {

StepOptions options_of(const RuleSetting& setting) {
  return {.radius = setting.radius.value_or(5.0),
          .margin = setting.proves_motions() ? setting.margin : 0.0};
}

Ball ball_of(const RuleSetting& setting, const Activation& rule, const Motion& motion) {
  return rule.region(surroundings_of(motion, options_of(setting), rule.reach()));
}

Answer Pipeline::ask(const Motion& motion) const {
  const Step result = step(mesh, index, rule, solver, motion, options_of(setting), work);
  return {result.status, result.motion};
}

}  // namespace keepout::app
