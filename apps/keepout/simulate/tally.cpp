// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/tally.h"

#include "shared/names.h"

namespace keepout::app {

void BodyTally::add(double clearance, double required, double from_setpoint) {
  // A clearance that is NaN proves nothing, so it counts against the guard.
  below += clearance >= required ? 0 : 1;
  in_mesh += clearance >= 0.0 ? 0 : 1;
  deepest = std::max(deepest, -clearance);
  least = std::min(least, clearance);
  error = std::max(error, from_setpoint);
}

void RunTally::add(const std::vector<Cycle>& stroke, const StrokeStart& start) {
  const double required = start.required;
  const std::size_t inside_before = any.in_mesh, breaches_before = breaches;
  for (const Cycle& cycle : stroke) {
    ++outcomes[static_cast<std::size_t>(cycle.outcome)];
    breaches += cycle.is_breach ? 1 : 0;
    guides_left += cycle.is_guide_left ? 1 : 0;
    farthest_out = std::max(farthest_out, cycle.guide_excess);
    guides_inside |= cycle.guides_inside;
    any.add(cycle.least(), required);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      bodies[b].add(cycle.clearances[b], required, cycle.errors[b]);
    }
    least = std::min(least, cycle.least());
    times_us.push_back(static_cast<double>(cycle.step_us));
  }
  const bool is_inside = any.in_mesh > inside_before;
  ++strokes;
  cycles += stroke.size();
  starts_too_close += start.actual >= required ? 0 : 1;
  strokes_inside += is_inside ? 1 : 0;
  strokes_breached += is_inside || breaches > breaches_before ? 1 : 0;
}

std::uint32_t guides_inside(std::span<const GuideState> guides) {
  std::uint32_t inside = 0;
  for (std::size_t g = 0; g < guides.size(); ++g) {
    if (guides[g].excess <= 0.0) inside |= std::uint32_t{1} << g;
  }
  return inside;
}

std::vector<std::string> untested_guides(std::span<const RunTally> runs,
                                         std::span<const std::string> texts) {
  std::uint32_t inside = 0;
  for (const RunTally& run : runs) inside |= run.guides_inside;
  std::vector<std::string> untested;
  for (std::size_t g = 0; g < texts.size(); ++g) {
    if ((inside >> g & 1) == 0) untested.push_back("'" + texts[g] + "'");
  }
  return untested;
}

std::string sentence_on_untested(const std::vector<std::string>& guides) {
  if (guides.empty()) return "";
  const bool is_one = guides.size() == 1;
  return std::string(is_one ? " Guide " : " Guides ") + listed(guides) +
         " tested nothing: no stroke was ever inside " + (is_one ? "it." : "them.");
}

}  // namespace keepout::app
