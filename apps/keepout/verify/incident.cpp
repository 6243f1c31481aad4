// SPDX-License-Identifier: BSD-3-Clause
#include "incident.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace keepout::app {
namespace {

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

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

void to_json(Json& json, const Incident& i) {
  const StepOptions& o = i.setup.options;
  json = {{"what", i.what},
          {"scene", i.scene},
          {"trajectory", i.trajectory},
          {"cycle", i.cycle},
          {"start", i.setup.start->name},
          {"route", name(i.setup.route)},
          {"longest_step", i.setup.longest_step},
          {"joints", i.setup.joints},
          {"has_limits", i.setup.has_limits},
          {"start_tip", json_of(i.setup.tip)},
          {"radius", o.radius},
          {"tool_radius", o.tool_radius},
          {"margin", o.margin},
          {"damping", o.damping},
          {"recovery", o.recovery},
          {"refinements", o.refinements},
          {"nodes", o.nodes},
          {"query", o.query == Query::sphere ? "sphere" : "motion"},
          {"inside", i.setup.inside == Inside::led_out ? "led_out" : "taken_as_is"},
          {"tip", json_of(i.tip)},
          {"desired", json_of(i.desired)},
          {"motion", json_of(i.motion)},
          {"status", name(i.status)},
          {"jacobian", i.jacobian},
          {"row_matrix", i.row_matrix},
          {"row_bounds", i.row_bounds},
          {"distance", i.verdict.distance},
          {"allowed", i.verdict.threshold},
          {"tau", i.verdict.tolerance},
          {"triangle", i.verdict.triangle}};
}

std::string text(const Json& incident) {
  constexpr std::array<std::string_view, 6> first_of_a_line{"start",   "radius", "tip",
                                                            "desired", "motion", "distance"};
  constexpr std::array<std::string_view, 3> left_out{"jacobian", "row_matrix", "row_bounds"};
  std::string text;
  for (const auto& [key, value] : incident.items()) {
    if (std::ranges::find(left_out, key) != left_out.end()) continue;
    const bool begins_line = std::ranges::find(first_of_a_line, key) != first_of_a_line.end();
    text += begins_line ? "\n  " : text.empty() ? "" : " ";
    text += key + ' ' + (value.is_string() ? value.get<std::string>() : value.dump());
  }
  return text + '\n';
}

}  // namespace keepout::app
