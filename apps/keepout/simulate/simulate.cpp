// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/simulate.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <iterator>
#include <span>
#include <utility>

#include "keepout/error.h"
#include "record/report_page.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/progress.h"
#include "shared/robot_file.h"
#include "shared/stop_signal.h"
#include "simulate/simulated_tool.h"

namespace keepout::app {
namespace {

/// The results of all strokes on all meshes, at all speeds, under all guards.
struct Runs {
  std::vector<RunTally> runs = {};        // only those with a finished stroke
  std::shared_ptr<const Mesh> mesh = {};  // the last
  std::size_t finished = 0, planned = 0;  // strokes

  bool is_complete() const noexcept { return finished == planned; }
};

/// Follows a stroke under all guards, and adds it to their runs. Returns false if a signal came
/// before the stroke was finished; then it adds nothing.
bool follow_stroke(SimulatedTool& tool, Stroke stroke, std::span<RunTally> runs,
                   const StopSignal& stop) {
  FollowedStroke followed{.stroke = std::move(stroke)};
  std::vector<StrokeStart> starts;
  for (std::size_t guard = 0; guard < runs.size(); ++guard) {
    starts.push_back(tool.start(followed.stroke, guard));
    auto& cycles = followed.runs.emplace_back();
    for (const Pose& goal : followed.stroke.goals) {
      if (stop.has_come()) return false;
      cycles.push_back(tool.follow(goal));
    }
  }
  for (std::size_t guard = 0; guard < runs.size(); ++guard) {
    runs[guard].add(followed.runs[guard], starts[guard]);
  }
  tool.keep(std::move(followed));
  return true;
}

/// Runs the closed loops until a signal comes.
Runs run_strokes(SimulatedTool& tool, const std::vector<std::filesystem::path>& meshes,
                 const std::vector<double>& speeds, std::size_t count, const StopSignal& stop) {
  Runs all{.planned = meshes.size() * speeds.size() * count};
  Progress progress("simulate", all.planned);
  for (const auto& mesh : meshes) {
    progress.show(mesh.stem().string());
    all.mesh = tool.open(mesh, stop);
    if (!all.mesh) return all;
    const std::vector<std::string> guards = tool.guards();
    for (const double speed : speeds) {
      std::vector<RunTally> runs;
      for (const std::string& guard : guards) {
        runs.push_back({.mesh = mesh.stem().string(), .speed = speed, .guard = guard});
      }
      for (std::uint64_t number = 0; number < count && !stop.has_come(); ++number) {
        Stroke stroke;
        try {
          stroke = tool.draw(number, speed);
        } catch (const Error& error) {
          throw Error(mesh.string() + ": " + error.what());
        }
        if (!follow_stroke(tool, std::move(stroke), runs, stop)) break;
        ++all.finished;
        stop.keep_from_now_on();
        progress.advance();
      }
      if (runs.front().strokes > 0) std::ranges::move(runs, std::back_inserter(all.runs));
      if (stop.has_come()) return all;
    }
  }
  return all;
}

/// Prints the last lines on the terminal.
void print_next(const SimulateOptions& options, const Json& record, std::ostream& out) {
  out << (missing_template(record).empty() ? "\nReport, with pictures, tables and settings: "
                                           : "\nReport, with tables and settings, no pictures: ")
      << options.files.page->string() << '\n';
  if (is_quiet() || options.called_as.empty()) return;
  std::string robot = options.robot.empty() ? "" : " --robot " + shell_word(options.robot);
  if (!options.bodies.empty()) robot += " --bodies " + shell_word(options.bodies.string());
  const std::filesystem::path name = options.meshes.empty() ? "skull" : options.meshes.front();
  const std::string mesh = mesh_words(name, options.load);
  std::string verified = shell_word(name.string());  // by a command that takes meshes as they are
  std::vector<std::pair<std::string, const char*>> lines{
      {"inspect " + mesh, "what the mesh is made of, and what is wrong with it"}};
  if (mesh != verified) {
    verified = "CONVERTED.ply";
    lines.emplace_back("convert " + mesh + " " + verified, "the mesh as it was read, for verify");
  }
  lines.emplace_back(
      "verify " + verified + (robot.empty() ? " --steps 1e5" : robot + " --cycles 1e4"),
      "attack the certified rule; an exact oracle judges");
  lines.emplace_back("simulate YOUR_MESH.stl" + robot, "the same on a mesh of yours, in mm");
  lines.emplace_back("--help", "all commands");
  out << "\nTry next:\n";
  for (auto& [arguments, what] : lines) {
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
  OutputFiles outputs =
      options.files.open(meshes, "MESH", robot_inputs(options.robot, options.bodies));
  const StopSignal stop(keeps_what_is_finished, BeforeWork::ends_process);
  const Runs done = run_strokes(*tool, meshes, has_tip ? std::vector{1.0} : options.speeds,
                                options.strokes.count, stop);
  auto [record, columns, legend, is_broken, is_untested] = tool->result(done.runs);
  print_rows(out, columns, done.runs);
  out << legend << '\n';
  PartTimings timings;
  try {
    // The benchmark has many tables, which few readers need.
    std::ostream tables(options.is_verbose ? out.rdbuf() : nullptr);
    if (options.is_timing_parts && done.is_complete()) {
      timings = options.time_parts(options, done.mesh, stop, tables);
      record["benchmark"] = timings.benchmark;
      record["comparison"] = timings.comparison;
    }
  } catch (const std::exception& error) {  // the simulation is complete and must be reported
    std::cerr << "keepout: the benchmark is omitted: " << error.what() << '\n';
  }
  const bool is_complete = done.is_complete() && timings.complete;
  record["complete"] = is_complete;
  write_record(outputs, record, options.files);
  print_wrapped(out, record["subject"].get<std::string>() + ".");
  print_wrapped(out, record["headline"]);
  if (timings.combinations > 0) {
    out << "Timed as well, in the report: " << counted(timings.combinations, "combination")
        << " of index, rule, solver and radius.\n";
  }
  print_next(options, record, out);
  if (!done.is_complete()) {
    out.flush();
    std::cerr << "keepout: stopped; " << grouped(done.finished) << " of "
              << counted(done.planned, "stroke") << " were finished, and are kept in "
              << options.files.names() << '\n';
  }
  if (timings.is_wrong) {
    std::cerr << "keepout: parts give wrong answers: see the benchmark in the report\n";
  }
  if (is_broken || timings.is_wrong) return EXIT_FAILURE;
  if (!is_complete) return exit_interrupted;
  return is_untested ? EXIT_FAILURE : EXIT_SUCCESS;
}

}  // namespace keepout::app
