// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulate.h"

#include <array>
#include <cstdio>
#include <fstream>
#include <ostream>
#include <utility>

#include "clip.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/load_mesh.h"
#include "keepout/error.h"
#include "progress.h"
#include "report/html_report.h"
#include "simulation_record.h"

namespace keepout::app {
namespace {

/// Moves a tip for one cycle: with a fixture, or freely.
class Tool {
 public:
  virtual ~Tool() = default;
  struct Move {
    Vec3 motion;
    Outcome outcome;
    float microseconds;
  };
  virtual Move move(const Vec3& tip, const Vec3& desired) = 0;
};

class FreeTool final : public Tool {
 public:
  Move move(const Vec3&, const Vec3& desired) override {
    return {desired, Outcome::moved_freely, 0.0F};
  }
};

class GuardedTool final : public Tool {
 public:
  explicit GuardedTool(MotionConstraint constraint) : constraint_(std::move(constraint)) {}

  Move move(const Vec3& tip, const Vec3& desired) override {
    StageTimes times;
    const Step step = constraint_.step({.tip = tip, .desired = desired}, times);
    // Less than a nanometre when more was asked for is standing still.
    const bool still = step.motion.norm() < 1e-6 && desired.norm() > 1e-3;
    const Outcome outcome = !step.ok() || still              ? Outcome::stopped
                            : step.status == Status::limited ? Outcome::limited
                                                             : Outcome::moved_freely;
    return {step.motion, outcome, static_cast<float>(1e-3 * static_cast<double>(times.total()))};
  }

 private:
  MotionConstraint constraint_;
};

Run run_strokes(std::string rule, std::string description, Tool& tool,
                const std::vector<std::vector<Vec3>>& hand, double max_step, Audit& audit) {
  Run run{.rule = std::move(rule), .description = std::move(description)};
  Progress progress("simulate " + run.rule, hand.size());
  for (const std::vector<Vec3>& goals : hand) {
    Vec3 tip = goals.front();
    double clearance = audit.clearance(tip);
    Stroke& stroke = run.strokes.emplace_back();
    for (const Vec3& goal : goals) {
      const Tool::Move move = tool.move(tip, clipped(goal - tip, max_step));
      const Vec3 from = std::exchange(tip, tip + move.motion);
      clearance = audit.clearance(tip, std::abs(clearance) + move.motion.norm());
      if (audit.crosses(from, tip)) {
        run.crossings.push_back({run.strokes.size() - 1, stroke.cycles.size()});
      }
      stroke.cycles.push_back({goal, tip, clearance, move.microseconds, move.outcome});
    }
    progress.advance();
  }
  return run;
}

std::string number(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

/// The processor's name, as the system tells it.
std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::vector<std::pair<std::string, std::string>> settings_of(const SimulateOptions& options,
                                                             const Mesh& mesh) {
  return {{"triangles", std::to_string(mesh.triangle_count())},
          {"vertices", std::to_string(mesh.vertex_count())},
          {"index", options.constraint.index},
          {"solver", options.constraint.solver},
          {"motion sphere radius", number(options.constraint.radius) + " mm"},
          {"margin", number(options.constraint.margin) + " mm"},
          {"longest step asked for", number(options.max_step) + " mm"},
          {"seed", std::to_string(options.hand.seed)},
          {"strokes", std::to_string(options.hand.strokes)},
          {"cycles per stroke", std::to_string(options.hand.cycles)},
          {"processor", processor()},
          {"compiler", KEEPOUT_COMPILER},
          {"build", KEEPOUT_BUILD_TYPE},
          {"keepout", KEEPOUT_VERSION}};
}

std::string description_of(std::string_view rule) {
  for (const ActivationEntry& entry : activation_rules()) {
    if (entry.name == rule) return std::string(entry.description);
  }
  return {};
}

void print_table(const Simulation& simulation, std::ostream& out) {
  std::array<char, 256> line;
  std::snprintf(line.data(), line.size(), "%-10s %8s %9s %9s %9s %12s %12s %8s %10s %9s\n", "rule",
                "cycles", "kHz", "p50 us", "p99 us", "closest mm", "deepest mm", "inside",
                "crossings", "stopped");
  out << line.data();
  for (const Run& run : simulation.runs) {
    const RunSummary s = summarize(run);
    std::snprintf(line.data(), line.size(),
                  "%-10s %8zu %9.1f %9.2f %9.2f %12.4f %12.4f %8zu %10zu %9zu\n", run.rule.c_str(),
                  s.cycles, s.rate_khz, s.p50_us, s.p99_us, s.closest_approach,
                  s.deepest_penetration, s.cycles_inside, s.crossings, s.stopped);
    out << line.data();
  }
}

}  // namespace

void simulate(const SimulateOptions& options, std::ostream& out) {
  if (options.max_step > options.constraint.radius) {
    throw Error(
        "--max-step is longer than --radius: no step may leave the motion sphere; lower "
        "the one or raise the other");
  }
  const LoadedMesh loaded = load_mesh(options.mesh);
  for (const std::string& warning : loaded.warnings) out << "note: " << warning << '\n';
  // Before any work: a mistyped name shall not be told of after minutes.
  std::vector<std::pair<std::string, std::unique_ptr<Tool>>> tools;
  tools.emplace_back(no_rule, std::make_unique<FreeTool>());
  for (const std::string& rule : options.rules) {
    MotionConstraintSettings settings = options.constraint;
    settings.activation = rule;
    tools.emplace_back(
        rule, std::make_unique<GuardedTool>(make_motion_constraint(loaded.mesh, settings)));
  }

  Audit audit(loaded.mesh);
  Simulation simulation{.mesh_name = options.mesh.stem().string(),
                        .mesh = loaded.mesh.get(),
                        .surface = audit.surface(),
                        .margin = options.constraint.margin,
                        .cycle_seconds = options.hand.cycle_seconds,
                        .settings = settings_of(options, *loaded.mesh)};
  const std::vector<std::vector<Vec3>> hand = make_hand(audit, options.hand);
  for (const auto& [rule, tool] : tools) {
    simulation.runs.push_back(
        run_strokes(rule, description_of(rule), *tool, hand, options.max_step, audit));
  }
  print_table(simulation, out);
  write_report(options.report, simulation);
  out << "report: " << options.report.string() << '\n';
}

}  // namespace keepout::app
