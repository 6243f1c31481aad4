// SPDX-License-Identifier: BSD-3-Clause
#include "report/figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base64.h"
#include "number_text.h"
#include "report/plot.h"
#include "report/png.h"
#include "report/text.h"
#include "report/verdict.h"

namespace keepout::app {
namespace {

std::string whole(double value) { return std::to_string(std::lround(value)); }

std::string image_element(const Image& image, const std::string& attributes) {
  return "<image " + attributes + "width=\"" + std::to_string(image.size.width) + "\" height=\"" +
         std::to_string(image.size.height) + "\" href=\"data:image/png;base64," +
         to_base64(to_png(image)) + "\"/>";
}

std::string open_picture(const std::string& css_class, ImageSize size,
                         const std::string& description) {
  return "<svg class=\"" + css_class + "\" viewBox=\"0 0 " + std::to_string(size.width) + " " +
         std::to_string(size.height) + "\" role=\"img\" aria-label=\"" + escape(description) +
         "\">";
}

/// A length that is one digit and zeros. [mm]
std::string round_length(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, mm < 0.01 ? "%g µm" : "%g mm", mm < 0.01 ? 1e3 * mm : mm);
  return text;
}

/// A bar of a round length, so that a reader can tell millimetres from centimetres.
std::string scale_bar(const Camera& camera, ImageSize size) {
  const double mm_per_pixel = camera.view_height / static_cast<double>(size.height);
  const double longest = 0.22 * static_cast<double>(size.width) * mm_per_pixel;
  const double power = std::pow(10.0, std::floor(std::log10(longest)));
  double length = power;
  for (const double round : {2.0, 5.0}) {
    if (round * power <= longest) length = round * power;
  }
  const double x = 0.03 * static_cast<double>(size.width);
  const double y = 0.96 * static_cast<double>(size.height);
  return "<path d=\"M" + whole(x) + "," + whole(y - 10.0) + "v20m0,-10h" +
         whole(length / mm_per_pixel) + "m0,-10v20\"/><text class=\"scale\" x=\"" + whole(x) +
         "\" y=\"" + whole(y - 22.0) + "\">" + round_length(length) + "</text>";
}

/// What to call a moment at which the tip is where it must not be. Past an open surface, the
/// distance tells no depth.
std::string damage(const Cycle& cycle) {
  return cycle.clearance < 0.0 ? length_text(-cycle.clearance) + " deep" : "passed through";
}

std::string distance(const Cycle& cycle) {
  return touches(cycle.clearance) ? "touching" : length_text(cycle.clearance) + " away";
}

/// Says at the ball how deep the tip is there; an arrow points the way when it is out of
/// sight.
std::string depth_label(const CloseUp& view, ImageSize size, const Cycle& cycle, bool bad) {
  const PicturePoint p = project(view.camera, size, cycle.tip);
  const double width = static_cast<double>(size.width), height = static_cast<double>(size.height);
  std::string words = bad ? damage(cycle) : distance(cycle);
  if (!shows(view.camera, size, cycle.tip)) {
    words = (p.y > height ? "↓ " : p.y < 0.0 ? "↑ " : p.x > width ? "→ " : "← ") + words;
  }
  const double low = 0.93 * height;
  const bool to_left = p.x > 0.55 * width;
  const double x = std::clamp(p.x + (to_left ? -26.0 : 26.0), 0.05 * width, 0.95 * width);
  const double y = std::clamp(p.y + 50.0, 0.08 * height, low);  // below: above, the path goes on
  return "<text class=\"" + std::string(bad ? "bad" : "good") + "\" x=\"" + whole(x) + "\" y=\"" +
         whole(y) + "\" text-anchor=\"" + (to_left ? "end" : "start") + "\">" + words + "</text>";
}

/// A ring around the deepest place of a run that let the tool in, so that a small place is found.
std::string ring(const Simulation& simulation, const Overview& view, std::size_t run) {
  const Run& one = simulation.runs[run];
  const RunSummary summary = summarize(one);
  if (summary.kept_out() || one.rule == no_rule) return {};
  const Moment worst = worst_moment(one, run);
  const ImageSize size = view.anatomy.size;
  const Cycle& cycle = one.strokes[worst.stroke].cycles[worst.cycle];
  const PicturePoint p = project(view.camera, size, cycle.tip);
  const bool to_left = p.x > 0.55 * static_cast<double>(size.width);
  const std::string words = damage(cycle);
  return "<circle cx=\"" + whole(p.x) + "\" cy=\"" + whole(p.y) +
         "\" r=\"30\"/><text class=\"bad\" x=\"" + whole(p.x + (to_left ? -44.0 : 44.0)) +
         "\" y=\"" + whole(p.y + 10.0) + "\" text-anchor=\"" + (to_left ? "end" : "start") + "\">" +
         words + "</text>";
}

Series clearance_series(const Simulation& simulation, std::size_t run, std::size_t stroke) {
  Series series{display_name(simulation.runs[run]), rule_class(run), {}};
  const std::vector<Cycle>& cycles = simulation.runs[run].strokes[stroke].cycles;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    series.points.push_back(
        {static_cast<double>(i) * simulation.cycle_seconds, cycles[i].clearance});
  }
  return series;
}

Plot clearance(const Simulation& simulation, std::size_t stroke) {
  Plot plot;
  plot.x.label = "time [s]";
  plot.y.label = "tip to surface [mm]";
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    plot.series.push_back(clearance_series(simulation, r, stroke));
  }
  plot.markers.push_back({Marker::Across::at_y, 0.0, "surface"});
  if (simulation.surface == SurfaceKind::closed) {
    plot.bands.push_back({-1e9, 0.0, "inside the anatomy"});
  }
  return plot;
}

}  // namespace

std::string rule_class(std::size_t run) { return "rule-" + std::to_string(run % 6); }

std::string shared_anatomy(const Overview& view) {
  return "<svg width=\"0\" height=\"0\" style=\"position:absolute\" aria-hidden=\"true\"><defs>" +
         image_element(view.anatomy, "id=\"anatomy\" ") + "</defs></svg>";
}

std::string overview_picture(const Simulation& simulation, const Overview& view, std::size_t run) {
  const Image& paths = view.paths[run];
  return open_picture("picture on-stage", paths.size,
                      "The anatomy with the paths of the tool tip, " +
                          display_name(simulation.runs[run]) +
                          "; in red where the tip is inside.") +
         "<use href=\"#anatomy\"/>" + image_element(paths, "") + ring(simulation, view, run) +
         scale_bar(view.camera, paths.size) + "</svg>";
}

std::string close_up_picture(const Simulation& simulation, const Moment& moment,
                             const CloseUp& view, std::size_t run) {
  const ImageSize size = view.picture.size;
  const Cycle& cycle = simulation.runs[run].strokes[moment.stroke].cycles[view.worst];
  const bool bad = trespass(simulation.runs[run], moment.stroke, simulation.surface)[view.worst];
  const bool closed = simulation.surface == SurfaceKind::closed;
  return open_picture(closed ? "picture" : "picture on-stage", size,
                      "Section along the path of the tip in stroke " +
                          std::to_string(moment.stroke + 1) + ", " +
                          display_name(simulation.runs[run]) + ": " +
                          (bad ? damage(cycle) : distance(cycle)) + ".") +
         image_element(view.picture, "") + scale_bar(view.camera, size) +
         depth_label(view, size, cycle, bad) + "</svg>";
}

std::string clearance_plot(const Simulation& simulation, std::size_t stroke) {
  Plot plot = clearance(simulation, stroke);
  plot.description =
      "Distance of the tool tip to the surface over the time of one stroke, for each "
      "rule; below zero the tip is inside the anatomy.";
  return to_svg(plot);
}

std::string near_surface_plot(const Simulation& simulation, std::size_t stroke) {
  Plot plot = clearance(simulation, stroke);
  double low = 0.0, nearest = 0.0;
  for (const Run& run : simulation.runs) {
    if (run.rule == no_rule) continue;
    const double worst = run.strokes[stroke].cycles[worst_cycle(run, stroke)].clearance;
    low = std::min(low, worst);
    nearest = std::max(nearest, worst);
  }
  if (simulation.margin > 0.0) {
    plot.markers.push_back({Marker::Across::at_y, simulation.margin, "margin"});
  }
  double room = std::max({-low, nearest, simulation.margin});
  // Where no rule failed, no more than a reader cares for: rules that only touch leave no room.
  if (low == 0.0) room = std::max(room, 0.1);
  plot.y.low = low - 0.5 * room;
  plot.y.high = 2.5 * room;
  plot.description = "The same distances, enlarged around the surface.";
  return to_svg(plot);
}

std::string step_time_plot(const Simulation& simulation) {
  Plot plot;
  plot.description = "For each rule, the part of all steps that took at least so long.";
  plot.x = {.label = "time of a step [µs]", .scale = Axis::Scale::logarithmic};
  plot.y = {.label = "steps at least as slow",
            .scale = Axis::Scale::logarithmic,
            .high = 100.0,
            .tick_suffix = " %"};
  for (std::size_t r = 0; r < simulation.runs.size(); ++r) {
    std::vector<double> times;
    for (const Stroke& stroke : simulation.runs[r].strokes) {
      for (const Cycle& cycle : stroke.cycles) {
        if (cycle.step_us > 0.0F) times.push_back(static_cast<double>(cycle.step_us));
      }
    }
    if (times.empty()) continue;
    std::sort(times.begin(), times.end());
    Series series{display_name(simulation.runs[r]), rule_class(r), {}};
    const auto count = static_cast<double>(times.size());
    for (std::size_t i = 0; i < times.size(); ++i) {
      series.points.push_back({times[i], 100.0 * (count - static_cast<double>(i)) / count});
    }
    plot.series.push_back(std::move(series));
  }
  if (plot.series.empty()) return {};
  const double cycle_us = 1e6 * simulation.cycle_seconds;
  double slowest = cycle_us;
  for (const Series& series : plot.series) slowest = std::max(slowest, series.points.back().x);
  plot.x.high = 1.3 * slowest;
  plot.markers.push_back({Marker::Across::at_x, cycle_us, "one control cycle"});
  return to_svg(plot);
}

}  // namespace keepout::app
