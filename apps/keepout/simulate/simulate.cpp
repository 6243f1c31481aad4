// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/simulate.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <span>
#include <utility>

#include "keepout/error.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"
#include "simulate/simulated_tool.h"

namespace keepout::app {
namespace {

/// All strokes on all meshes, at all speeds, under all guards.
struct Runs {
  std::vector<RunTally> runs = {};
  std::shared_ptr<const Mesh> mesh = {};  // the last
  bool is_complete = true;                // false if a signal came
};

/// Runs the closed loops. Stops after the stroke in which a signal came.
Runs run_strokes(SimulatedTool& tool, const std::vector<std::filesystem::path>& meshes,
                 const std::vector<double>& speeds, std::size_t count) {
  const StopSignal stop;
  Progress progress("simulate", meshes.size() * speeds.size() * count);
  Runs all;
  for (const auto& mesh : meshes) {
    if (!all.is_complete) break;
    all.mesh = tool.open(mesh);
    const std::vector<std::string> guards = tool.guards();
    for (const double speed : speeds) {
      for (const std::string& guard : guards) {
        all.runs.push_back({.mesh = mesh.stem().string(), .speed = speed, .guard = guard});
      }
      const auto runs = std::span(all.runs).last(guards.size());
      for (std::uint64_t number = 0; number < count && all.is_complete; ++number) {
        FollowedStroke followed;
        try {
          followed.stroke = tool.draw(number, speed);
        } catch (const Error& error) {
          throw Error(mesh.string() + ": " + error.what());
        }
        for (std::size_t guard = 0; guard < guards.size(); ++guard) {
          const double required = tool.start(followed.stroke, guard);
          auto& cycles = followed.runs.emplace_back();
          for (const Pose& goal : followed.stroke.goals) cycles.push_back(tool.follow(goal));
          runs[guard].add(cycles, required);
        }
        tool.keep(std::move(followed));
        progress.advance();
        all.is_complete = !stop.has_come();
      }
    }
  }
  return all;
}

/// The last lines on the terminal.
void print_next(const SimulateOptions& options, const std::string& mesh, std::ostream& out) {
  const std::string robot = options.robot.empty() ? "" : " --robot " + options.robot;
  out << "\nReport, with pictures, tables and settings: " << options.files.page->string() << '\n';
  if (options.called_as.empty()) return;
  out << "\nTry next:\n";
  for (auto [arguments, what] : std::initializer_list<std::pair<std::string, const char*>>{
           {"inspect " + mesh, "what the mesh is made of, and what is wrong with it"},
           {"verify " + mesh + (robot.empty() ? " --steps 1e5" : robot + " --cycles 1e4"),
            "attack the certified rule; an exact oracle judges"},
           {"simulate YOUR_MESH.stl" + robot, "the same on a mesh of yours, in mm"},
           {"--help", "all commands"}}) {
    constexpr std::size_t column = 40;
    arguments.insert(0, options.called_as + ' ');
    arguments.resize(std::max(arguments.size(), column), ' ');
    out << "  " << arguments << "  # " << what << '\n';
  }
}

}  // namespace

int simulate(const SimulateOptions& options, std::ostream& out) {
  const bool has_tip = options.robot.empty();
  const auto tool = has_tip ? make_guarded_tip(options) : options.make_instrument(options);
  std::vector<std::filesystem::path> meshes = options.meshes;
  if (meshes.empty()) meshes = {"skull", "airway", "brain"};
  OutputFiles outputs = options.files.open(meshes);
  const Runs done = run_strokes(*tool, meshes, has_tip ? std::vector{1.0} : options.speeds,
                                options.strokes.count);
  auto [record, columns, legend, is_broken] = tool->result(done.runs);
  print_rows(out, columns, done.runs);
  out << legend << '\n';
  PartTimings timings;
  try {
    // The tables of the benchmark are many, and mean little to a reader who does not know it.
    std::ostream tables(options.is_verbose ? out.rdbuf() : nullptr);
    if (options.is_timing_parts && done.is_complete) {
      timings = options.time_parts(options, done.mesh, tables);
      record["benchmark"] = timings.benchmark;
      record["comparison"] = timings.comparison;
    }
  } catch (const std::exception& error) {  // the simulation is complete, and kept
    std::cerr << "keepout: the benchmark is left out: " << error.what() << '\n';
  }
  const bool is_complete = done.is_complete && timings.complete;
  record["complete"] = is_complete;
  write_record(outputs, record, options.files, std::cerr);
  print_wrapped(out, record["subject"].get<std::string>() + ".");
  print_wrapped(out, record["headline"]);
  if (timings.combinations > 0) {
    out << "Timed as well, in the report: " << counted(timings.combinations, "combination")
        << " of index, rule, solver and radius.\n";
  }
  print_next(options, shell_word(meshes.front().string()), out);
  return is_broken ? EXIT_FAILURE : is_complete ? EXIT_SUCCESS : exit_interrupted;
}

}  // namespace keepout::app
