// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/tracking_columns.h"

#include <algorithm>
#include <cmath>

#include "operators/attacker.h"
#include "operators/strokes.h"
#include "shared/names.h"

namespace keepout::app {
namespace {

double millimeters_per_second(double speed) { return speed * fastest_way / cycle_seconds; }

bool is_measured(const RunTally& run) { return run.guard == physical_mode_names.back(); }

double largest_error(const RunTally& run) {
  return std::ranges::max_element(run.bodies, {}, &BodyTally::error)->error;
}

/// Returns a length, rounded up to 0.01 mm; "-" for null.
std::string rounded_up(const Json& mm) {
  return mm.is_null() ? "-" : formatted("%.2f", std::ceil(100.0 * mm.get<double>()) / 100.0);
}

}  // namespace

Columns<RunTally> tracking_columns(Columns<RunTally> modes, std::span<const Body> bodies,
                                   const InstrumentOptions& options) {
  Columns<RunTally> columns = std::move(modes);
  for (auto& column : columns) {
    // The terminal shows the speed in mm/s, and the least clearance instead of a depth.
    if (column.key == "speed" || column.key.ends_with("_in_mesh") ||
        column.key.ends_with("_deepest_mm")) {
      column.width = 0;
    }
  }
  columns.insert(
      columns.begin() + 1,
      {{"margin_mm", [margin = options.margin](const RunTally&) { return Json(margin); }},
       {"mm_per_s", [](const RunTally& run) { return Json(millimeters_per_second(run.speed)); },
        "mm/s", 5, figure_text<3>}});
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string& body = bodies[b].name;
    const auto error = [b](const RunTally& run) {
      return is_measured(run) ? Json(run.bodies[b].error) : Json(nullptr);
    };
    columns.push_back({body + "_least_mm",
                       [b](const RunTally& run) { return or_null(run.bodies[b].least); },
                       body + " least", 11, number_text<"%.3f">});
    columns.push_back({body + "_error_mm", error, "error", 6, number_text<"%.3f">});
    columns.push_back({body + "_asks_mm",
                       [error, band = options.band](const RunTally& run) {
                         const Json mm = error(run);
                         return mm.is_null() ? mm : Json(mm.get<double>() + band);
                       },
                       "asks", 5, rounded_up});
  }
  return columns;
}

std::string sentence_on_tracking(std::span<const RunTally> runs, double band) {
  double error = 0.0;
  std::size_t touching = 0;
  for (const RunTally& run : runs) {
    if (!is_measured(run)) continue;
    error = std::max(error, largest_error(run));
    touching += run.any.in_mesh;
  }
  return " The measured instrument was up to " + formatted("%.2f", error) +
         " mm from its setpoint, which asks for a margin of " + rounded_up(error + band) +
         " mm. It reached into the mesh in " + counted(touching, "cycle") + ".";
}

}  // namespace keepout::app
