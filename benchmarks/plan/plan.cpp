// SPDX-License-Identifier: BSD-3-Clause
#include "plan/plan.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <ostream>
#include <utility>

#include "plan/planning.h"
#include "record/flat_rows.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"
#include "shared/wrapped_text.h"

namespace keepout::app {
namespace {

/// Runs the planner of the options, and has the path judged.
Json run_planner(const PlanOptions& options, Planning& planning, const PlanningProblem& problem,
                 const Checker& checker, std::size_t repetition, const StopSignal& stop) {
  const bool is_tip = options.robot.empty();
  const std::uint64_t seed = options.seed + (is_tip ? problem.number : repetition);
  const SolvedPath path =
      solve(planning, checker, problem, options, seed, [&stop] { return stop.has_come(); });
  Json run{{"mesh", planning.scene().name()}, {"problem", problem.number}};
  if (is_tip) {
    run.update(problem.members);
    run["checker"] = checker.name();
    run["planner"] = checker.slides() ? "SlidingConnect" : options.planner;
  } else {
    run["seed"] = seed;
    run["checker"] = checker.name();
    run.update(problem.members);
  }
  run["solved"] = !path.states.empty();
  run["seconds"] = path.seconds;
  run["checking_seconds"] = path.checking_seconds;
  run["checks"] = path.checks;
  run.update(planning.judge(path.states));
  return run;
}

/// All runs on a mesh, up to a stop.
void run_all(const PlanOptions& options, Planning& planning, Progress& progress,
             const StopSignal& stop, Json& runs) {
  const std::string& mesh = planning.scene().name();
  progress.show(mesh + ", drawing problems");
  for (const PlanningProblem& problem : planning.draw()) {
    planning.open(problem);
    for (const Checker& checker : checkers_of(options)) {
      progress.show(mesh + " " + std::to_string(problem.number) + ", " + checker.name());
      for (std::size_t i = 0; i < options.repetitions(); ++i) {
        if (stop.has_come()) return;
        Json run = run_planner(options, planning, problem, checker, i, stop);
        // Cut short it tells nothing.
        if (stop.has_come() && !run["solved"]) return;
        runs.push_back(std::move(run));
        progress.advance();
      }
    }
  }
}

}  // namespace

int plan(const PlanOptions& options, std::ostream& out) {
  OutputFiles outputs = options.files.open(options.meshes);
  const StopSignal stop;  // after the files, which a second signal removes
  const auto plannings =
      options.robot.empty() ? plannings_of_a_tip(options) : plannings_of_an_instrument(options);
  const std::size_t total =
      plannings.size() * options.problems * checkers_of(options).size() * options.repetitions();
  Json runs = Json::array();
  {
    Progress progress("plan", total);
    for (const auto& planning : plannings) {
      if (!stop.has_come()) run_all(options, *planning, progress, stop, runs);
    }
  }
  const bool is_complete = runs.size() == total;
  const Json record = record_of(options, plannings, std::move(runs), is_complete);
  const Json& all = record["runs"];
  if (auto* const csv = outputs.stream("--csv")) print_csv(*csv, flat(all));
  write_record(outputs, record, options.files, std::cerr);
  print_wrapped(out, record["subject"]);
  out << '\n';
  print_summaries(out, all);
  if (stop.has_come()) {
    out << "\ninterrupted: " << all.size() << " of " << total << " runs are finished\n";
  }
  out << '\n';
  print_wrapped(out, record["headline"]);
  const auto breaks_a_promise = [](const Json& run) {
    return is_keepouts(run) && run["solved"] && !is_valid(run);
  };
  if (std::ranges::any_of(all, breaks_a_promise)) return EXIT_FAILURE;
  return stop.has_come() ? exit_interrupted : EXIT_SUCCESS;
}

}  // namespace keepout::app
