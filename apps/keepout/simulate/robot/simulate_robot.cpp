// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <ostream>

#include "keepout/error.h"
#include "record/drawn_mesh.h"
#include "record/json_parts.h"
#include "shared/named_mesh.h"
#include "shared/number_text.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"
#include "simulate/robot/guarded_stroke.h"
#include "simulate/simulate.h"

namespace keepout::app {
namespace {

/// A stroke that the report shows: on a mesh, of its manner, the one that says most.
struct KeptStroke {
  double told = -1.0;  // by how much bodies that were guarded missed the margin, in all modes [mm]
  Json json = {};
};

const Columns<ModeTally>& mode_columns() {
  static const Columns<ModeTally> all = [] {
    Columns<ModeTally> columns{
        {"mesh", &ModeTally::mesh, "mesh", -12},
        {"speed", &ModeTally::speed, "speed", 5},
        {"mode", [](const ModeTally& t) { return Json(name(t.mode)); }, "mode", -10},
        {"cycles", &ModeTally::cycles, "cycles", 7},
        {"refused", &ModeTally::refused, "refused", 7},
        {"limits_broken", &ModeTally::limits_broken, "limits", 6}};
    for (std::size_t b = 0; b < body_names.size(); ++b) {
      const std::string body(body_names[b]);
      const auto add = [&](const char* key, auto figure, const std::string& heading, int width) {
        columns.push_back({body + key,
                           [=](const ModeTally& t) { return Json(t.bodies[b].*figure); }, heading,
                           width});
      };
      add("_below", &BodyTally::below, body + " close", 11);
      add("_in_mesh", &BodyTally::in_mesh, "in mesh", 7);
      add("_deepest_mm", &BodyTally::deepest, "deepest", 7);
      columns.back().text = [](const Json& mm) { return formatted("%.2f", mm.get<double>()); };
    }
    return columns;
  }();
  return all;
}

constexpr const char* columns_meaning =
    R"(close: cycles in which the body was closer than the certified distance, as an independent judge sees
five poses of each; in mesh: of them, those in which the mesh reached into it; deepest: how far, in mm,
at most its radius. refused: cycles without a proven motion; limits: cycles that broke a joint's.

)";

/// In one mode: which cycle was worst, and all that is drawn of it.
Json run_json(Mode mode, const std::vector<GuardedCycle>& cycles) {
  Json places = Json::array(), clearances = Json::array();
  for (const GuardedCycle& cycle : cycles) {
    Json& at = places.emplace_back();
    for (const Vec3& place : cycle.places) {
      at.push_back(json_of(Vec3((1e3 * place).array().round() / 1e3)));
    }
    Json& least = clearances.emplace_back();
    for (const double mm : cycle.clearances) {
      least.push_back(or_null(std::round(1e6 * mm) / 1e6));
    }
  }
  const auto worst = std::ranges::min_element(cycles, {}, &GuardedCycle::least);
  return {{"mode", name(mode)},
          {"worst", worst - cycles.begin()},
          {"places", std::move(places)},
          {"clearance_mm", std::move(clearances)}};
}

/// Makes stroke `number` in the mode of each row, and keeps it if it says more than the one there.
void run_stroke(const HandSettings& hand, RobotScene& on, std::uint64_t number,
                std::span<ModeTally> rows, std::span<KeptStroke> kept) {
  Random of_seed(hand.seed);
  Random random(of_seed.bits() ^ number);
  const std::size_t manner = number % manners.size();
  const double speed = rows.front().speed;
  const auto stroke = make_robot_stroke(on, manners[manner], speed, hand.cycles, random);
  if (!stroke) {
    throw Error(on.scene.name() +
                ": no place was found where an instrument can begin, 5 to 20 mm before the surface "
                "with its shaft free; is the mesh in mm?");
  }
  KeptStroke one{0.0,
                 {{"manner", name(manners[manner])},
                  {"speed", speed},
                  {"number", number},
                  {"port", json_of(stroke->start.base.position)},
                  {"runs", Json::array()}}};
  for (ModeTally& row : rows) {
    const auto cycles = follow(*stroke, on, random, row);
    one.json["runs"].push_back(run_json(row.mode, cycles));
    const double least = std::ranges::min(cycles, {}, &GuardedCycle::least).least();
    if (row.mode != Mode::none) one.told += std::max(0.0, on.margin - least);
  }
  if (one.told > kept[manner].told) kept[manner] = std::move(one);
}

/// All rows of a mode together.
ModeTally sum_of(const std::vector<ModeTally>& rows, Mode mode) {
  ModeTally sum;
  for (const ModeTally& row : rows) {
    if (row.mode != mode) continue;
    sum.cycles += row.cycles;
    sum.limits_broken += row.limits_broken;
    sum.any.below += row.any.below;
    sum.any.in_mesh += row.any.in_mesh;
    sum.any.deepest = std::max(sum.any.deepest, row.any.deepest);
  }
  return sum;
}

Json record_of(const SimulateOptions& options, const std::vector<ModeTally>& rows, Json meshes,
               bool is_complete) {
  std::vector<std::string> account;
  for (const Mode mode : modes) {
    const BodyTally any = sum_of(rows, mode).any;
    account.push_back("Mode “" + std::string(name(mode)) + "”: some body was too close in " +
                      counted(any.below, "cycle") + ", in the mesh in " + grouped(any.in_mesh) +
                      (any.in_mesh > 0 ? ", up to " + length_text(any.deepest) + "." : "."));
  }
  const ModeTally certified = sum_of(rows, Mode::certified);
  const bool is_kept = certified.any.below + certified.limits_broken == 0;
  const double margin = options.constraint.options.margin;
  Json record =
      new_record({.kind = "simulate_robot",
                  .command = options.command,
                  .complete = is_complete,
                  .subject = "A simulated operator drove the instrument of a robot, " +
                             options.robot + ", against anatomy: the same strokes in each mode",
                  .headline = std::string("The certified step ") +
                              (is_kept ? "kept shaft, wrist and jaw off the anatomy in all "
                                       : "broke its promise in some of ") +
                              counted(certified.cycles, "cycle") + ".",
                  .account = account,
                  .machine = this_machine(),
                  .settings = {{"robot", options.robot},
                               {"strokes", grouped(options.hand.strokes)},
                               {"cycles per stroke", grouped(options.hand.cycles)},
                               {"margin", trimmed(margin) + " mm"},
                               {"seed", std::to_string(options.hand.seed)},
                               {"index", options.constraint.index}}});
  const Instrument instrument = robots_under_test().front().make({});
  record["certified_mm"] =
      margin - options_of({.margin = margin}, instrument.chain(), options.speeds.front()).band;
  for (std::size_t b = 0; b < body_names.size(); ++b) {
    record["bodies"].push_back(
        {{"name", body_names[b]}, {"radius_mm", instrument.bodies()[b].radius}});
  }
  record["rows"] = json_of(mode_columns(), rows);
  record["meshes"] = std::move(meshes);
  return record;
}

}  // namespace

int simulate_robot(const SimulateOptions& options, std::ostream& out) {
  std::vector<std::filesystem::path> named = options.meshes;
  if (named.empty()) named = {"skull", "airway", "brain"};
  OutputFiles outputs = options.files.open(named);
  const StopSignal stop;
  Progress progress("simulate", named.size() * options.speeds.size() * options.hand.strokes);
  std::vector<ModeTally> rows;
  Json meshes = Json::array();
  for (const auto& mesh : named) {
    RobotScene on{{mesh.stem().string(), load_named_mesh(mesh).mesh, options.constraint.index},
                  options.constraint.options.margin};
    const Scene& scene = on.scene;
    std::array<KeptStroke, manners.size()> kept;
    for (const double speed : options.speeds) {
      for (const Mode mode : modes) rows.push_back({scene.name(), speed, mode});
      for (std::uint64_t n = 0; n < options.hand.strokes && !stop.has_come(); ++n) {
        run_stroke(options.hand, on, n, std::span(rows).last(modes.size()), kept);
        progress.advance();
      }
    }
    Json& drawn = meshes.emplace_back(drawn_mesh(scene.name(), *scene.mesh()));
    drawn["surface"] = scene.has_sides() ? "closed" : "open";
    drawn["strokes"] = Json::array();
    for (KeptStroke& one : kept) {
      if (one.told >= 0.0) drawn["strokes"].push_back(std::move(one.json));
    }
    if (stop.has_come()) break;
  }
  progress.interrupt();
  const Json record = record_of(options, rows, std::move(meshes), !stop.has_come());
  write_record(outputs, record, options.files, std::cerr);
  print_rows(out, mode_columns(), rows);
  out << columns_meaning;
  print_wrapped(out, record["headline"]);
  print_wrapped(out, record["account"]);
  out << "\nReport, with pictures: " << options.files.page->string() << '\n';
  const ModeTally certified = sum_of(rows, Mode::certified);
  if (certified.any.below + certified.limits_broken > 0) return EXIT_FAILURE;
  return stop.has_come() ? exit_interrupted : EXIT_SUCCESS;
}

}  // namespace keepout::app
