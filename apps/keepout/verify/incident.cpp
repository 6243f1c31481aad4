// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "incident.h"

#include <array>
#include <cstdio>
#include <utility>

namespace keepout::app {
namespace {

std::string digits(double value) {
  std::array<char, 40> text;
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text.data();
}

std::string digits(const Vec3& v) {
  return digits(v.x()) + ' ' + digits(v.y()) + ' ' + digits(v.z());
}

}  // namespace

Incident make_incident(std::string what, const Scene& scene, const Setup& setup,
                       const Motion& motion, const Step& step, const Verdict& verdict) {
  Incident incident{.what = std::move(what),
                    .scene = scene.name(),
                    .setup = setup,
                    .tip = motion.tip,
                    .desired = motion.desired,
                    .motion = step.motion,
                    .status = step.status,
                    .verdict = verdict};
  if (motion.jacobian) {
    const auto count = static_cast<std::size_t>(3 * motion.jacobian->joints());
    incident.jacobian.assign(motion.jacobian->data(), motion.jacobian->data() + count);
  }
  if (motion.rows) {
    const auto rows = static_cast<std::size_t>(motion.rows->count());
    const std::size_t columns = motion.jacobian ? incident.jacobian.size() / 3 : 3;
    incident.row_matrix.assign(motion.rows->matrix(), motion.rows->matrix() + rows * columns);
    incident.row_bounds.assign(motion.rows->bounds(), motion.rows->bounds() + rows);
  }
  return incident;
}

std::string text(const Incident& i) {
  const StepOptions& options = i.setup.options;
  return i.what + ": " + i.scene + ", trajectory " + std::to_string(i.trajectory) + ", cycle " +
         std::to_string(i.cycle) + " (" + std::string(name(i.setup.start)) + ", " +
         std::string(name(i.setup.route)) + ")" + "\n  radius " + digits(options.radius) +
         " margin " + digits(options.margin) + " damping " + digits(options.damping) +
         " recovery " + digits(options.recovery) + " refinements " +
         std::to_string(options.refinements) + " nodes " + std::to_string(options.nodes) +
         " query " + (options.query == Query::sphere ? "sphere" : "motion") + " inside " +
         (i.setup.inside == Inside::led_out ? "led_out" : "taken_as_is") + " joints " +
         std::to_string(i.setup.joints) + (i.row_bounds.empty() ? "" : " with limits") +
         "\n  tip " + digits(i.tip) + "\n  desired " + digits(i.desired) + "\n  motion " +
         digits(i.motion) + " " + std::string(name(i.status)) + "\n  distance " +
         digits(i.verdict.distance) + " allowed " + digits(i.verdict.threshold) + " tau " +
         digits(i.verdict.tolerance) + " triangle " + std::to_string(i.verdict.triangle) + "\n";
}

}  // namespace keepout::app
