// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/tip_record.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "keepout/activation/registry.h"
#include "record/drawn_mesh.h"
#include "record/json_parts.h"
#include "shared/names.h"

namespace keepout::app {
namespace {

using Strokes = std::vector<FollowedStroke>;

/// The tool, the surface and the guides of a simulation.
struct TipScene {
  SurfaceKind surface;
  bool has_tool;  // a convex tool: its contacts are counted, and it has no depth
  bool has_guides;

  /// Returns true if the depth inside the anatomy is known.
  bool has_depth() const noexcept { return surface == SurfaceKind::closed && !has_tool; }
};

/// Returns the smallest clearance; 0 if the tip was inside, crossed the surface, or touched it
/// within the accuracy of the audit. [mm]
double closest(const RunTally& run) {
  return run.kept_out() && run.least > Audit::touching ? run.least : 0.0;
}

Columns<RunTally> columns_of(const TipScene& scene) {
  // An unguarded run has no step to time.
  const auto timed = [](auto figure) {
    return [=](const RunTally& run) {
      std::vector<double> times = run.times_us;
      const Timing timing = timing_of(times);
      return timing.max > 0.0 ? Json(figure(timing)) : Json();
    };
  };
  const auto inside = [is_known = scene.has_depth()](auto figure) {
    return [=](const RunTally& run) { return is_known ? Json(figure(run)) : Json(); };
  };
  const auto with = [](Outcome outcome) {
    return [=](const RunTally& run) { return Json(run.with(outcome)); };
  };
  Columns<RunTally> columns{
      {"", &RunTally::guard, "rule", -10},
      {"strokes", &RunTally::strokes},
      {"cycles", &RunTally::cycles, "cycles", 8},
      {"rate_khz", timed([](const Timing& t) { return 1000.0 / t.p50; }), "kHz", 9,
       number_text<"%.1f">},
      {"p50_us", timed([](const Timing& t) { return t.p50; }), "p50 us", 9, number_text<"%.2f">},
      // With too few steps for a percentile, its rank is that of the slowest step.
      {"p99_us", timed([](const Timing& t) { return t.p99.value_or(t.max); }), "p99 us", 9,
       number_text<"%.2f">},
      {"p999_us", timed([](const Timing& t) { return t.p999.value_or(t.max); })},
      {"max_us", timed([](const Timing& t) { return t.max; })},
      {"closest_approach_mm", closest, "closest mm", 12, number_text<"%.4f">},
      {"deepest_mm", inside([](const RunTally& run) { return run.any.deepest; }), "deepest mm", 12,
       number_text<"%.4f">},
      {"cycles_inside", inside([](const RunTally& run) { return run.any.in_mesh; }), "inside", 8,
       number_text<"%.0f">},
      {"strokes_inside", inside([](const RunTally& run) { return run.strokes_inside; })},
      {"crossings", &RunTally::breaches, scene.has_tool ? "contacts" : "crossings", 10},
      {"strokes_breached", &RunTally::strokes_breached, "breached", 9},
      {"starts_too_close", &RunTally::starts_too_close, "near starts", 11},
      {"moved_freely", with(Outcome::moved_freely)},
      {"limited", with(Outcome::limited)},
      {"stopped", with(Outcome::stopped), "stopped", 9}};
  if (scene.has_guides) {
    columns.push_back({"guides_left", &RunTally::guides_left, "left guide", 11});
    columns.push_back(
        {"farthest_out_mm", &RunTally::farthest_out, "out mm", 9, number_text<"%.4f">});
  }
  return columns;
}

/// Returns how a run kept its guides, to append to its other words; empty without guides.
std::string guide_words(const RunTally& run, bool has_guides) {
  if (!has_guides) return "";
  if (run.guides_left == 0) return "; left no guide";
  return "; left a guide in " + counted(run.guides_left, "cycle") + ", by up to " +
         length_text(run.farthest_out);
}

/// Returns the outcome of a run in a few words: "went up to 1.2 mm deep, in 3 of 24 strokes".
std::string words(const RunTally& run, const TipScene& scene) {
  if (run.stood_still()) {
    return "stood still in all " + counted(run.cycles, "cycle") +
           (run.starts_too_close == 0
                ? ""
                : "; " + grouped(run.starts_too_close) + " of " + counted(run.strokes, "stroke") +
                      " began nearer than the required clearance");
  }
  if (run.kept_out()) {
    const std::string near = closest(run) == 0.0
                                 ? " but touched the surface"
                                 : ", never nearer than " + length_text(closest(run));
    const std::size_t stopped = run.with(Outcome::stopped);
    return "stayed outside" + near +
           (stopped > 0 ? "; stood still in " + counted(stopped, "cycle") : "");
  }
  if (scene.has_tool) {
    return "touched the surface in " + counted(run.breaches, "cycle") + ", in " +
           grouped(run.strokes_breached) + " of " + counted(run.strokes, "stroke");
  }
  const std::string how =
      scene.surface == SurfaceKind::open ? "through the surface " + how_often(run.breaches)
      : run.any.in_mesh == 0             ? "right through the anatomy within a single cycle"
                                         : "up to " + length_text(run.any.deepest) + " deep";
  return "went " + how + ", in " + grouped(run.strokes_breached) + " of " +
         counted(run.strokes, "stroke");
}

/// Returns "Rule 'a'" or "Rules 'a' and 'b'".
std::string rules_text(const std::vector<std::string>& rules) {
  return (rules.size() == 1 ? "Rule " : "Rules ") + listed(rules);
}

/// Returns in how many cycles the tool stood still under each rule, in their order; empty if that
/// does not differ.
std::string still_text(const std::vector<RunTally>& runs) {
  std::vector<std::string> counts;
  for (std::size_t r = 1; r < runs.size(); ++r)
    counts.push_back(grouped(runs[r].with(Outcome::stopped)));
  const bool is_same = std::ranges::count(counts, counts.front()) == std::ssize(counts);
  return is_same ? "" : "; in this order, it stood still in " + listed(counts) + " cycles";
}

/// Returns a sentence on whether all rules kept the tool in its guides.
std::string guide_sentence(const std::vector<RunTally>& runs) {
  std::size_t left = 0;
  double out = 0.0;
  for (std::size_t r = 1; r < runs.size(); ++r) {
    left += runs[r].guides_left;
    out = std::max(out, runs[r].farthest_out);
  }
  if (left > 0) return " The tool left a guide in " + counted(left, "cycle") + ".";
  return " The tool left no guide by more than promised" +
         (out <= 0.0 ? "."
                     : "; it was at most " + length_text(out) +
                           " outside, which includes strokes that began outside.");
}

/// Returns which rules kept the tool out, which did not, and which were not tested because the tool
/// did not move. `required`: the required clearance of the rules. [mm]
std::string headline(const std::vector<RunTally>& runs, const TipScene& scene, double required) {
  if (runs.size() == 1) return "The tool moved without any fixture.";
  std::vector<std::string> kept_out, let_in, still;
  for (std::size_t r = 1; r < runs.size(); ++r) {
    // Quotation marks separate names of rules from the sentence.
    (runs[r].stood_still() ? still
     : runs[r].kept_out()  ? kept_out
                           : let_in)
        .push_back("'" + runs[r].guard + "'");
  }
  const RunTally& free = runs.front();
  const bool is_closed = scene.has_depth();
  std::string text;
  if (!let_in.empty()) {
    text = rules_text(let_in) + (scene.has_tool ? " let the tool touch the surface"
                                 : is_closed    ? " let the tool into the anatomy"
                                                : " let the tool through the surface");
    if (!kept_out.empty()) {
      text += "; " + listed(kept_out) + (is_closed ? " kept it out" : " did not");
    }
    text += ".";
  } else if (!kept_out.empty()) {
    if (!free.kept_out()) text = "Without a fixture the tool " + words(free, scene) + ". ";
    const std::string differs = still.empty() ? still_text(runs) : "";
    text += rules_text(kept_out) +
            (scene.has_tool ? " kept the whole tool off the surface"
             : is_closed    ? " kept the tool out of the anatomy"
                            : " kept the tool from passing through the surface") +
            differs + ".";
  }
  if (!still.empty()) {
    text += (text.empty() ? "" : " ") + rules_text(still) +
            " tested nothing: the tool stood still in all " + counted(runs.back().cycles, "cycle") +
            ".";
  }
  if (free.starts_too_close > 0) {
    text += " " + grouped(free.starts_too_close) + " of " + counted(free.strokes, "stroke") +
            " began nearer to the surface than the required clearance, " + length_text(required) +
            ": is the mesh in millimeters?";
  }
  if (free.kept_out()) text += " Without a fixture it stayed out too: these strokes test no rule.";
  return scene.has_guides ? text + guide_sentence(runs) : text;
}

/// One cycle of a run.
struct Moment {
  std::size_t stroke = 0;
  std::size_t cycle = 0;
};

Json moment_json(const Moment& moment) {
  return {{"stroke", moment.stroke}, {"cycle", moment.cycle}};
}

/// The moments of a run that the page shows.
struct Moments {
  /// The deepest penetration; without one the first crossing, and else the nearest approach.
  Moment worst = {};
  double least = Cycle::far;  // smallest clearance [mm]
  std::vector<Moment> crossings = {};
};

Moments moments_of(const Strokes& strokes, std::size_t run) {
  Moments moments;
  for (std::size_t s = 0; s < strokes.size(); ++s) {
    const std::vector<Cycle>& cycles = strokes[s].runs[run];
    for (std::size_t c = 0; c < cycles.size(); ++c) {
      if (cycles[c].least() < moments.least) moments.worst = {s, c};
      moments.least = std::min(moments.least, cycles[c].least());
      if (cycles[c].is_breach) moments.crossings.push_back({s, c});
    }
  }
  if (moments.least >= 0.0 && !moments.crossings.empty()) moments.worst = moments.crossings[0];
  return moments;
}

/// Returns the most informative run: the one with the deepest penetration under a rule, or else
/// with a crossing. If no rule failed, returns the unguarded run.
std::size_t telling_run(const std::vector<Moments>& moments) {
  const auto rank = [&](const Moments& of_run) {
    const bool is_harmless = of_run.least >= 0.0 && of_run.crossings.empty();
    const bool has_rule = &of_run != &moments.front();
    return std::pair(is_harmless ? 0 : has_rule ? 2 : 1, -of_run.least);
  };
  return static_cast<std::size_t>(std::ranges::max_element(moments, {}, rank) - moments.begin());
}

/// Rounds a number of a cycle to the digits of records.
double to_digits(double value, double parts_of_one) {
  return std::round(value * parts_of_one) / parts_of_one;
}
double length(double mm) { return to_digits(mm, 1e6); }

Json place(const Vec3& point) { return {length(point.x()), length(point.y()), length(point.z())}; }

Json stroke_json(const std::vector<Cycle>& cycles) {
  Json tips = Json::array(), clearances = Json::array(), times = Json::array();
  std::string outcomes;
  for (const Cycle& cycle : cycles) {
    tips.push_back(place(cycle.places.front()));
    clearances.push_back(length(cycle.least()));
    times.push_back(to_digits(static_cast<double>(cycle.step_us), 1e3));
    outcomes += "fls"[static_cast<int>(cycle.outcome)];
  }
  return {{"tip", std::move(tips)},
          {"clearance_mm", std::move(clearances)},
          {"step_us", std::move(times)},
          {"outcome", std::move(outcomes)}};
}

/// Returns the bounds of the tips of all runs in a stroke, enlarged on all sides by half of their
/// diagonal.
Box around(const FollowedStroke& followed) {
  const Vec3 first = followed.runs.front().front().places.front();
  Box box{first, first};
  for (const std::vector<Cycle>& cycles : followed.runs) {
    for (const Cycle& cycle : cycles) {
      box = {box.low.cwiseMin(cycle.places.front()), box.high.cwiseMax(cycle.places.front())};
    }
  }
  const Vec3 far = Vec3::Constant(0.5 * box.size().norm());
  return {box.low - far, box.high + far};
}

/// Returns a convex tool in a few words.
std::string tool_text(const ConvexTool& tool) {
  return "convex: hull of " + counted(tool.points().size(), "point") + ", grown by " +
         keepout::text_of(tool.radius()) + " mm";
}

Json settings_of(const SimulateOptions& options) {
  const StepOptions& step = options.constraint.options;
  const auto& tool = options.constraint.tool;
  Json settings{{"mesh", options.meshes.front().string()},
                {"index", options.constraint.index},
                {"solver", options.constraint.solver},
                {"motion sphere radius", keepout::text_of(step.radius) + " mm"},
                {tool ? "tool" : "tool radius",
                 tool ? tool_text(*tool) : keepout::text_of(step.tool_radius) + " mm"},
                {"margin", keepout::text_of(step.margin) + " mm"},
                {"refinements", std::to_string(step.refinements)},
                {"branches", std::to_string(step.nodes)},
                {"longest step asked for", keepout::text_of(options.max_step) + " mm"},
                {"seed", std::to_string(options.strokes.seed)},
                {"strokes", std::to_string(options.strokes.count)},
                {"cycles per stroke", std::to_string(options.strokes.cycles)}};
  if (options.constraint.monitor) settings["monitor"] = "confirms each motion";
  if (!options.guides.empty()) settings["guides"] = listed(options.guides);
  return settings;
}

/// Returns the description of a rule, for the page.
std::string description_of(const std::string& rule, bool has_tool) {
  if (rule == no_rule) return "the tool moves as commanded";
  if (has_tool) return "the rule of convex tools: each motion of the whole tool is proved";
  return std::string(activation_rules().named(rule).description);
}

}  // namespace

SimulationResult tip_result(const SimulateOptions& options, const Audit& audit,
                            const Strokes& strokes, const std::vector<RunTally>& runs) {
  const RunTally& free = runs.front();
  const double margin = required_clearance(options.constraint.options);
  const TipScene scene{audit.surface(), options.constraint.tool.has_value(),
                       !options.guides.empty()};
  const std::vector<std::string> untested = untested_guides(runs, options.guides);
  Json record = new_record(
      {.kind = "simulate",
       .command = options.command,
       .subject = "A simulated operator pushed a tool over and into " + free.mesh + " (" +
                  counted(audit.mesh().triangle_count(), "triangle") +
                  "): " + counted(free.strokes, "stroke") + ", " + counted(free.cycles, "cycle") +
                  " of 1 ms, without a fixture and under " + counted(runs.size() - 1, "rule") +
                  ", margin " + length_text(margin),
       .headline = headline(runs, scene, margin) + sentence_on_untested(untested),
       .machine = this_machine(),
       .settings = settings_of(options)});
  std::vector<Moments> moments;
  for (std::size_t r = 0; r < runs.size(); ++r) moments.push_back(moments_of(strokes, r));
  const std::size_t told = telling_run(moments);
  const Moment& moment = moments[told].worst;
  record["mesh"] = drawn_mesh(free.mesh, audit.mesh(), around(strokes[moment.stroke]));
  record["mesh"]["surface"] = audit.surface() == SurfaceKind::closed ? "closed" : "open";
  record["kept_mm"] = margin;
  record["has_convex_tool"] = scene.has_tool;
  record["guides"] = options.guides;
  record["cycle_s"] = cycle_seconds;
  record["up"] = {0.0, 0.0, 1.0};  // toward the head, in CT data
  record["moment"] = {{"run", told}, {"stroke", moment.stroke}, {"cycle", moment.cycle}};
  for (const FollowedStroke& followed : strokes) {
    Json& hand = record["hand"].emplace_back(Json::array());
    for (const Pose& goal : followed.stroke.goals) hand.push_back(place(goal.position));
  }
  const Columns<RunTally> columns = columns_of(scene);
  const auto guarded = std::span(runs).subspan(1);  // the first run is without a fixture
  bool is_broken = false;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const std::string& rule = runs[r].guard;
    const bool is_free = rule == no_rule;
    is_broken |= !is_free && (runs[r].guides_left > 0 || (scene.has_tool && !runs[r].kept_out()));
    Json run{{"rule", rule},
             {"name", is_free ? "no fixture" : rule},
             {"description", description_of(rule, scene.has_tool)},
             {"kept_out", runs[r].kept_out()},
             {"words", words(runs[r], scene) + guide_words(runs[r], scene.has_guides)},
             {"summary", json_of(columns, runs[r])},
             {"worst", moment_json(moments[r].worst)},
             {"strokes", Json::array()},
             {"crossings", Json::array()}};
    for (const FollowedStroke& followed : strokes) {
      run["strokes"].push_back(stroke_json(followed.runs[r]));
    }
    for (const Moment& crossing : moments[r].crossings) {
      run["crossings"].push_back(moment_json(crossing));
    }
    record["runs"].push_back(std::move(run));
  }
  for (const char* part : {"comparison", "benchmark"}) record[part] = nullptr;
  return {
      .record = std::move(record),
      .columns = columns,
      .is_broken = is_broken,
      .is_untested = (!guarded.empty() && std::ranges::all_of(guarded, &RunTally::stood_still)) ||
                     (scene.has_guides && untested.size() == options.guides.size())};
}

}  // namespace keepout::app
