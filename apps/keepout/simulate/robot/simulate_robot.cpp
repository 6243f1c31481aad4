// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/robot/simulate_robot.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <ostream>

#include "keepout/error.h"
#include "named_mesh.h"
#include "names.h"
#include "number_text.h"
#include "progress.h"
#include "record/drawn_mesh.h"
#include "record/json_parts.h"
#include "simulate/robot/guarded_stroke.h"
#include "stop_signal.h"
#include "wrapped_text.h"

namespace keepout::app {
namespace {

/// A stroke that is kept for the report: on a mesh, of its manner, the one that says most.
struct KeptStroke {
  Manner manner;
  double speed;
  std::uint64_t number;  // of those of its row, from 0
  Vec3 port;
  std::array<std::vector<GuardedCycle>, modes.size()> runs;  // one for each mode
  double told;  // by how much bodies that were guarded missed the margin, in all modes [mm]
};

std::string count_text(const Json& value) { return grouped(value.get<std::uint64_t>()); }
std::string depth_text(const Json& value) { return formatted("%.2f", value.get<double>()); }

const Columns<ModeTally>& mode_columns() {
  using Tally = ModeTally;
  static const Columns<Tally> all = [] {
    Columns<Tally> columns{{"mesh", &Tally::mesh, "mesh", -9},
                           {"triangles", &Tally::triangles},
                           {"speed", &Tally::speed, "speed", 5,
                            [](const Json& v) { return trimmed(v.get<double>()); }},
                           {"mode", [](const Tally& t) { return Json(name(t.mode)); }, "mode", -10},
                           {"strokes", &Tally::strokes, "strokes", 7, &count_text},
                           {"cycles", &Tally::cycles, "cycles", 7, &count_text},
                           {"refused", &Tally::refused, "refused", 7, &count_text},
                           {"limits_broken", &Tally::limits_broken, "limits", 6, &count_text},
                           {"below", &Tally::below}};
    for (std::size_t b = 0; b < body_names.size(); ++b) {
      const std::string body(body_names[b]);
      const auto add = [&](const char* key, auto figure, std::string heading, int width,
                           auto text) {
        columns.push_back({body + key, [=](const Tally& t) { return Json(t.bodies[b].*figure); },
                           std::move(heading), width, text});
      };
      add("_below", &BodyTally::below, "| " + body + ": close", 14, &count_text);
      add("_in_mesh", &BodyTally::in_mesh, "in mesh", 7, &count_text);
      add("_deepest_mm", &BodyTally::deepest, "deepest", 7, &depth_text);
    }
    return columns;
  }();
  return all;
}

/// [mm], so fine as is drawn, or told.
Json rounded_to(double value, double parts) {
  return std::isfinite(value) ? Json(std::round(value * parts) / parts) : Json(nullptr);
}

Json stroke_json(const KeptStroke& kept) {
  Json runs = Json::array();
  for (const Mode mode : modes) {
    const auto& cycles = kept.runs[static_cast<std::size_t>(mode)];
    Json places = Json::array(), clearances = Json::array();
    for (const GuardedCycle& cycle : cycles) {
      Json& at = places.emplace_back(Json::array());
      for (const Vec3& place : cycle.places) {
        for (const double x : place) at.push_back(rounded_to(x, 1e3));
      }
      Json& least = clearances.emplace_back(Json::array());
      for (const double mm : cycle.clearances) least.push_back(rounded_to(mm, 1e6));
    }
    const auto least = [](const GuardedCycle& cycle) { return std::ranges::min(cycle.clearances); };
    const auto worst = std::ranges::min_element(cycles, {}, least);
    runs.push_back({{"mode", name(mode)},
                    {"worst", worst - cycles.begin()},
                    {"places", std::move(places)},
                    {"clearance_mm", std::move(clearances)}});
  }
  return {{"manner", name(kept.manner)},
          {"speed", kept.speed},
          {"number", kept.number},
          {"port", json_of(kept.port)},
          {"runs", std::move(runs)}};
}

/// All strokes on a mesh.
class RobotStrokes {
 public:
  RobotStrokes(const SimulateOptions& options, Scene& scene) : options_(options), scene_(scene) {}

  /// Adds a row for each mode at a speed.
  void begin(double speed) {
    for (const Mode mode : modes) {
      rows_.push_back({.mesh = scene_.name(),
                       .triangles = scene_.mesh()->triangle_count(),
                       .speed = speed,
                       .mode = mode});
    }
  }

  void run(std::uint64_t number) {
    const RobotUnderTest& robot = robots_under_test().front();
    const double margin = options_.constraint.margin;
    const std::span rows = std::span(rows_).last(modes.size());
    const double speed = rows.front().speed;
    Random of_seed(options_.hand.seed);
    Random random(of_seed.bits() ^ number);
    const Manner manner = manners[number % manners.size()];
    const auto stroke = make_robot_stroke(scene_, tree_, robot, manner, margin, speed,
                                          options_.hand.cycles, random);
    if (!stroke) {
      throw Error(
          scene_.name() +
          ": no place was found where an instrument can begin, 5 to 20 mm before the surface "
          "with its shaft free; is the mesh in mm?");
    }
    KeptStroke one{manner, speed, number, stroke->start.base.position, {}, 0.0};
    for (ModeTally& row : rows) {
      auto& cycles = one.runs[static_cast<std::size_t>(row.mode)];
      cycles = follow(*stroke, scene_, tree_, robot, margin, random, row);
      double least = margin;
      for (const GuardedCycle& cycle : cycles) {
        least = std::min(least, std::ranges::min(cycle.clearances));
      }
      if (row.mode != Mode::none) one.told += margin - least;
    }
    const auto same = std::ranges::find(kept_, manner, &KeptStroke::manner);
    if (same == kept_.end()) {
      kept_.push_back(std::move(one));
    } else if (one.told > same->told) {
      *same = std::move(one);
    }
  }

  const std::vector<ModeTally>& rows() const noexcept { return rows_; }
  const std::vector<KeptStroke>& kept() const noexcept { return kept_; }

 private:
  const SimulateOptions& options_;
  Scene& scene_;
  std::shared_ptr<const oracle::TriangleTree> tree_ =
      std::make_shared<const oracle::TriangleTree>(scene_.mesh());
  std::vector<ModeTally> rows_;
  std::vector<KeptStroke> kept_;
};

/// One mode in all rows.
ModeTally total(const std::vector<ModeTally>& rows, Mode mode) {
  ModeTally sum;
  sum.mode = mode;
  for (const ModeTally& row : rows) {
    if (row.mode != mode) continue;
    sum.cycles += row.cycles;
    sum.below += row.below;
    sum.limits_broken += row.limits_broken;
    for (std::size_t b = 0; b < body_names.size(); ++b) {
      sum.bodies[b].in_mesh += row.bodies[b].in_mesh;
      sum.bodies[b].deepest = std::max(sum.bodies[b].deepest, row.bodies[b].deepest);
    }
  }
  return sum;
}

/// What became of the bodies, in a sentence.
std::string account_of(const ModeTally& sum) {
  constexpr std::array<std::string_view, 4> leads{
      "Certified on the motion that the joints make", "Certified on straight lines",
      "With only a ball at the jaw's tip guarded", "Without a guard"};
  std::vector<std::string> harms;
  for (std::size_t b = 0; b < body_names.size(); ++b) {
    const BodyTally& body = sum.bodies[b];
    if (body.in_mesh == 0) continue;
    harms.push_back("into the " + std::string(body_names[b]) + " in " +
                    counted(body.in_mesh, "cycle") + ", up to " + length_text(body.deepest));
  }
  return std::string(leads[static_cast<std::size_t>(sum.mode)]) + ", bodies came too close in " +
         counted(sum.below, "cycle") + " of " + grouped(sum.cycles) +
         (harms.empty() ? "; the mesh reached into none."
                        : "; the mesh reached " + listed(harms) + ".");
}

std::string headline_of(const ModeTally& certified) {
  if (certified.below + certified.limits_broken == 0) {
    return "The certified step kept shaft, wrist and jaw off the anatomy in all " +
           counted(certified.cycles, "cycle") + ".";
  }
  return "The certified step broke its promise: " + counted(certified.below, "cycle") +
         " too close, " + counted(certified.limits_broken, "joint limit") + " broken.";
}

Json record_of(const SimulateOptions& options, const std::vector<ModeTally>& rows, Json meshes,
               bool is_complete) {
  std::vector<std::string> account;
  for (const Mode mode : modes) account.push_back(account_of(total(rows, mode)));
  std::string speeds;
  for (const double s : options.speeds) speeds += (speeds.empty() ? "" : ",") + trimmed(s);
  const double margin = options.constraint.margin;
  const double band =
      options_of({.margin = margin}, robots_under_test().front().make({}).chain(), 1.0).band;
  Json record =
      new_record({.kind = "simulate_robot",
                  .command = options.command,
                  .complete = is_complete,
                  .subject = "A simulated operator drove the instrument of a robot, " +
                             options.robot + ", against anatomy, the same strokes in each mode",
                  .headline = headline_of(total(rows, Mode::certified)),
                  .account = account,
                  .machine = this_machine(),
                  .settings = {{"robot", options.robot},
                               {"strokes", grouped(options.hand.strokes)},
                               {"cycles per stroke", grouped(options.hand.cycles)},
                               {"speed", speeds},
                               {"margin", trimmed(margin) + " mm"},
                               {"seed", std::to_string(options.hand.seed)},
                               {"index", options.constraint.index}}});
  record["robot"] = options.robot;
  record["certified_mm"] = margin - band;
  record["bodies"] = Json::array();
  const Instrument instrument = robots_under_test().front().make({});
  for (std::size_t b = 0; b < body_names.size(); ++b) {
    record["bodies"].push_back(
        {{"name", body_names[b]}, {"radius_mm", instrument.bodies()[b].radius}});
  }
  record["rows"] = json_of(mode_columns(), rows);
  record["meshes"] = std::move(meshes);
  return record;
}

constexpr const char* legend =
    R"(close: cycles in which the body was closer than the certified distance, margin less band, as an
independent judge sees five poses of each; in mesh: of them, those in which the mesh reached into it;
deepest: how far, in mm, at most the body's radius. refused: cycles without a motion that could be
proven; limits: cycles that broke a joint's.
)";

}  // namespace

int simulate_robot(const SimulateOptions& options, std::ostream& out) {
  std::vector<std::filesystem::path> named = options.meshes;
  if (named.empty()) named = {"skull", "airway", "brain"};
  std::vector<NamedPath> inputs;
  for (const auto& mesh : named) inputs.push_back({"MESH", file_of_mesh(mesh)});
  OutputFiles outputs(inputs,
                      {{"--json", options.files.kept_json()}, {"--out", options.files.page}});
  const StopSignal stop;
  Progress progress("simulate", named.size() * options.speeds.size() * options.hand.strokes);
  std::vector<ModeTally> rows;
  Json meshes = Json::array();
  for (const auto& mesh : named) {
    if (stop.has_come()) break;
    progress.show(mesh.string());
    Scene scene(mesh.stem().string(), load_named_mesh(mesh).mesh, options.constraint.index);
    Json drawn = drawn_mesh(scene.name(), *scene.mesh());
    drawn["surface"] = scene.has_sides() ? "closed" : "open";
    drawn["strokes"] = Json::array();
    RobotStrokes strokes(options, scene);
    for (const double speed : options.speeds) {
      strokes.begin(speed);
      for (std::uint64_t n = 0; n < options.hand.strokes && !stop.has_come(); ++n) {
        strokes.run(n);
        progress.advance();
      }
    }
    rows.insert(rows.end(), strokes.rows().begin(), strokes.rows().end());
    for (const KeptStroke& kept : strokes.kept()) drawn["strokes"].push_back(stroke_json(kept));
    meshes.push_back(std::move(drawn));
  }
  progress.interrupt();
  const bool is_complete = !stop.has_come();
  const Json record = record_of(options, rows, std::move(meshes), is_complete);
  write_record(outputs, record, options.files, std::cerr);
  print_rows(out, mode_columns(), rows);
  out << legend << '\n';
  print_wrapped(out, record["headline"]);
  for (const Json& text : record["account"]) print_wrapped(out, text);
  out << "\nReport, with pictures: " << options.files.page->string() << '\n';
  const ModeTally certified = total(rows, Mode::certified);
  if (certified.below + certified.limits_broken > 0) return EXIT_FAILURE;
  return is_complete ? EXIT_SUCCESS : exit_interrupted;
}

}  // namespace keepout::app
