// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/pipeline.h"

#include "keepout/step/step.h"

namespace keepout::app {

StepOptions options_of(const RuleSetting& setting, const Motion& motion) {
  if (setting.proves_motions()) return {.radius = 5.0, .margin = setting.margin};
  return {.radius = setting.radius.value_or(motion.desired.norm())};
}

Ball ball_of(const RuleSetting& setting, const Activation& rule, const Motion& motion) {
  return rule.region(surroundings_of(motion, options_of(setting, motion), rule.reach()));
}

Answer Pipeline::ask(const Motion& motion) const {
  const Step result = step(mesh, index, rule, solver, motion, options_of(setting, motion), work);
  return {result.status, result.motion};
}

Answer Pipeline::ask(const Motion& motion, StageTimes& times) const {
  const StepOptions options = options_of(setting, motion);
  const Step result = step(mesh, index, rule, solver, motion, options, work, StageClock(times));
  return {result.status, result.motion};
}

}  // namespace keepout::app
