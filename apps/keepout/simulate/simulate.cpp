// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/simulate.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <ostream>
#include <utility>

#include "keepout/activation/registry.h"
#include "keepout/error.h"
#include "record/record.h"
#include "shared/clip.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/output_file.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"
#include "simulate/audit.h"
#include "simulate/simulation.h"

namespace keepout::app {
namespace {

/// Where a tip went in one cycle.
struct Move {
  Vec3 motion;
  Outcome outcome;
  float microseconds;
};

/// One cycle with a fixture, or, where there is none, freely.
Move run_cycle(std::optional<MotionConstraint>& constraint, const Vec3& tip, const Vec3& desired) {
  if (!constraint) return {desired, Outcome::moved_freely, 0.0F};
  StageTimes times;
  const Step step = constraint->step({.tip = tip, .desired = desired}, times);
  // Less than a nanometre when more was asked for is standing still.
  const bool still = step.motion.norm() < 1e-6 && desired.norm() > 1e-3;
  const Outcome outcome = !step.ok() || still           ? Outcome::stopped
                          : step.status != Status::free ? Outcome::limited
                                                        : Outcome::moved_freely;
  return {step.motion, outcome, static_cast<float>(1e-3 * static_cast<double>(times.total()))};
}

void run_strokes(std::optional<MotionConstraint>& constraint,
                 const std::vector<std::vector<Vec3>>& hand, double max_step, Audit& audit,
                 Run& run) {
  Progress progress("simulate " + run.rule, hand.size());
  for (const std::vector<Vec3>& goals : hand) {
    Vec3 tip = goals.front();
    PathAudit path(audit, tip);
    Stroke& stroke = run.strokes.emplace_back();
    for (const Vec3& goal : goals) {
      const Move moved = run_cycle(constraint, tip, clipped(goal - tip, max_step));
      tip += moved.motion;
      if (path.follow(tip)) {
        run.crossings.push_back({run.strokes.size() - 1, stroke.cycles.size()});
      }
      stroke.cycles.push_back({goal, tip, path.clearance(), moved.microseconds, moved.outcome});
    }
    progress.advance();
  }
}

Json settings_of(const SimulateOptions& options) {
  return {{"mesh", options.mesh.string()},
          {"index", options.constraint.index},
          {"solver", options.constraint.solver},
          {"motion sphere radius", keepout::text_of(options.constraint.options.radius) + " mm"},
          {"tool radius", keepout::text_of(options.constraint.options.tool_radius) + " mm"},
          {"margin", keepout::text_of(options.constraint.options.margin) + " mm"},
          {"refinements", std::to_string(options.constraint.options.refinements)},
          {"branches", std::to_string(options.constraint.options.nodes)},
          {"longest step asked for", keepout::text_of(options.max_step) + " mm"},
          {"seed", std::to_string(options.hand.seed)},
          {"strokes", std::to_string(options.hand.strokes)},
          {"cycles per stroke", std::to_string(options.hand.cycles)}};
}

/// Each once, in the order of their first mention.
std::vector<std::string> without_repeats(const std::vector<std::string>& rules) {
  std::vector<std::string> once;
  for (const std::string& rule : rules) {
    if (std::ranges::find(once, rule) == once.end()) once.push_back(rule);
  }
  return once;
}

/// The hand over a mesh; an error names its file.
std::vector<std::vector<Vec3>> hand_over(Audit& audit, const SimulateOptions& options) {
  try {
    return make_hand(audit, options.hand);
  } catch (const Error& error) {
    throw Error(options.mesh.string() + ": " + error.what());
  }
}

/// The last lines on the terminal.
void print_next(const SimulateOptions& options, std::ostream& out) {
  const std::string mesh = shell_word(options.mesh.string());
  out << "\nReport, with pictures, tables and settings: " << options.files.page->string() << "\n\n";
  const auto suggest = [&](const std::string& arguments, const char* what) {
    constexpr std::size_t column = 40;
    std::string command = options.called_as + ' ' + arguments;
    command.resize(std::max(command.size(), column), ' ');
    out << "  " << command << "  # " << what << '\n';
  };
  out << "Try next:\n";
  suggest("inspect " + mesh, "what the mesh is made of, and what is wrong with it");
  suggest("verify " + mesh + " --steps 1e5", "attack the certified rule; an exact oracle judges");
  suggest("simulate YOUR_MESH.stl", "the same on a mesh of yours, in mm");
  suggest("--help", "all commands");
}

}  // namespace

int simulate(const SimulateOptions& options, std::ostream& out) {
  if (!options.robot.empty()) return simulate_robot(options, out);
  require_within_reach(options.max_step, options.constraint.options.radius);
  OutputFiles outputs = options.files.open({options.mesh});
  const LoadedMesh loaded = load_named_mesh(options.mesh, options.load);
  // Nor a mistyped name.
  std::vector<std::pair<Run, std::optional<MotionConstraint>>> fixtures(1);
  fixtures.front().first.rule = no_rule;
  for (const std::string& rule : without_repeats(options.rules)) {
    MotionConstraintSettings settings = options.constraint;
    settings.activation = rule;
    settings.warn = warn_on_stderr;
    fixtures.emplace_back(Run{rule, std::string(activation_rules().named(rule).description)},
                          make_motion_constraint(loaded.mesh, settings));
  }

  Audit audit(loaded.mesh);
  Simulation simulation{
      .mesh_name = options.mesh.stem().string(),
      .mesh = loaded.mesh.get(),
      .surface = audit.surface(),
      .margin = options.constraint.options.tool_radius + options.constraint.options.margin,
      .cycle_seconds = cycle_seconds,
      .command = options.command,
      .settings = settings_of(options)};
  const std::vector<std::vector<Vec3>> hand = hand_over(audit, options);
  for (auto& [run, constraint] : fixtures) {
    run_strokes(constraint, hand, options.max_step, audit, run);
    simulation.runs.push_back(std::move(run));
  }
  // Those of the benchmark are many, and tell who does not know it of nothing but numbers.
  std::ostream tables(options.tables == Tables::printed ? out.rdbuf() : nullptr);
  print_table(tables, simulation);
  PartTimings timings;
  try {
    if (options.is_timing_parts) timings = options.time_parts(options, loaded.mesh, tables);
  } catch (const std::exception& error) {  // what was simulated is there, and kept
    std::cerr << "keepout: the benchmark is left out: " << error.what() << '\n';
  }
  Json record = record_of(simulation);
  record["benchmark"] = timings.benchmark;
  record["comparison"] = timings.comparison;
  record["complete"] = timings.complete;
  write_record(outputs, record, options.files, std::cerr);
  if (options.tables == Tables::printed) out << '\n';
  print_wrapped(out, record["subject"].get<std::string>() + ".");
  out << '\n';
  print_wrapped(out, record["headline"]);
  print_wrapped(out, record["account"]);
  if (timings.combinations > 0) {
    out << "Timed as well, in the report: " << counted(timings.combinations, "combination")
        << " of index, rule, solver and radius.\n";
  }
  print_next(options, out);
  return timings.complete ? EXIT_SUCCESS : exit_interrupted;
}

}  // namespace keepout::app
