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
#include "shared/wrapped_text.h"
#include "simulate/subject.h"

namespace keepout::app {
namespace {

/// All strokes on all meshes, at all speeds, under all guards.
struct Strokes {
  std::vector<RunTally> rows;                // one for each mesh, speed and guard
  std::vector<RunTally> totals;              // one for each guard
  std::shared_ptr<const Mesh> mesh = {};  // the last
  bool is_complete = true;                // false if a signal came
};

/// Draws a stroke; an error names the mesh.
Stroke draw(Subject& subject, const std::filesystem::path& mesh, std::uint64_t number,
            double speed) {
  try {
    return subject.draw(number, speed);
  } catch (const Error& error) {
    throw Error(mesh.string() + ": " + error.what());
  }
}

/// Runs the closed loops. Stops after the stroke in which a signal came.
Strokes run_strokes(Subject& subject, const std::vector<std::filesystem::path>& meshes,
                    const std::vector<double>& speeds, std::size_t count) {
  const StopSignal stop;
  Progress progress("simulate", meshes.size() * speeds.size() * count);
  Strokes all;
  for (const auto& mesh : meshes) {
    all.mesh = subject.open(mesh);
    const std::size_t guards = subject.guards().size();
    for (const double speed : speeds) {
      for (const std::string& guard : subject.guards()) {
        all.rows.push_back({.mesh = mesh.stem().string(), .speed = speed, .guard = guard});
        if (all.totals.size() < guards) all.totals.push_back({.guard = guard});
      }
      const auto rows = std::span(all.rows).last(guards);
      for (std::uint64_t number = 0; number < count && all.is_complete; ++number) {
        FollowedStroke followed{.stroke = draw(subject, mesh, number, speed)};
        for (std::size_t g = 0; g < guards; ++g) {
          const double required = subject.start(followed.stroke, g);
          auto& cycles = followed.runs.emplace_back();
          for (const Pose& goal : followed.stroke.goals) cycles.push_back(subject.follow(goal));
          rows[g].add(cycles, required);
          all.totals[g].add(cycles, required);
        }
        subject.keep(std::move(followed));
        progress.advance();
        all.is_complete = !stop.has_come();
      }
    }
    if (!all.is_complete) break;
  }
  for (RunTally& row : all.rows) row.step = timing_of(row.times_us);
  for (RunTally& total : all.totals) total.step = timing_of(total.times_us);
  return all;
}

/// The last lines on the terminal.
void print_next(const SimulateOptions& options, const std::filesystem::path& mesh,
                std::ostream& out) {
  const std::string name = shell_word(mesh.string());
  const std::string robot = options.has_robot() ? " --robot " + options.robot : "";
  out << "\nReport, with pictures, tables and settings: " << options.files.page->string() << "\n\n";
  const auto suggest = [&](const std::string& arguments, const char* what) {
    constexpr std::size_t column = 40;
    std::string command = options.called_as + ' ' + arguments;
    command.resize(std::max(command.size(), column), ' ');
    out << "  " << command << "  # " << what << '\n';
  };
  out << "Try next:\n";
  suggest("inspect " + name, "what the mesh is made of, and what is wrong with it");
  suggest("verify " + name + (options.has_robot() ? robot + " --cycles 1e4" : " --steps 1e5"),
          "attack the certified rule; an exact oracle judges");
  suggest("simulate YOUR_MESH.stl" + robot, "the same on a mesh of yours, in mm");
  suggest("--help", "all commands");
}

}  // namespace

int simulate(const SimulateOptions& options, std::ostream& out) {
  const auto subject =
      options.has_robot() ? make_instrument_subject(options) : make_tip_subject(options);
  std::vector<std::filesystem::path> meshes = options.meshes;
  if (meshes.empty()) meshes = {"skull", "airway", "brain"};
  OutputFiles outputs = options.files.open(meshes);
  const std::vector<double> speeds = options.has_robot() ? options.speeds : std::vector{1.0};
  const Strokes strokes = run_strokes(*subject, meshes, speeds, options.strokes.count);
  SimulationResult result = subject->result(strokes.rows, strokes.totals);
  // The tables of a tip are many, and mean little to a reader who does not know the rules.
  const bool is_printing = options.has_robot() || options.tables == Tables::printed;
  std::ostream tables(is_printing ? out.rdbuf() : nullptr);
  print_rows(tables, result.columns, strokes.rows);
  tables << result.legend;
  PartTimings timings;
  try {
    if (options.is_timing_parts && strokes.is_complete) {
      timings = options.time_parts(options, strokes.mesh, tables);
      result.record["benchmark"] = timings.benchmark;
      result.record["comparison"] = timings.comparison;
    }
  } catch (const std::exception& error) {  // the simulation is complete, and kept
    std::cerr << "keepout: the benchmark is left out: " << error.what() << '\n';
  }
  const bool is_complete = strokes.is_complete && timings.complete;
  result.record["complete"] = is_complete;
  write_record(outputs, result.record, options.files, std::cerr);
  tables << '\n';
  print_wrapped(out, result.record["subject"].get<std::string>() + ".");
  out << '\n';
  print_wrapped(out, result.record["headline"]);
  print_wrapped(out, result.record["account"]);
  if (timings.combinations > 0) {
    out << "Timed as well, in the report: " << counted(timings.combinations, "combination")
        << " of index, rule, solver and radius.\n";
  }
  print_next(options, meshes.front(), out);
  if (result.is_broken) return EXIT_FAILURE;
  return is_complete ? EXIT_SUCCESS : exit_interrupted;
}

}  // namespace keepout::app
