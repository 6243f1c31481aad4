// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/parts.h"
#include "bench/speed/certified_contact.h"
#include "bench/speed/families.h"
#include "bench/speed/stopwatch.h"
#include "keepout/solvers/registry.h"
#include "number_text.h"

namespace keepout::app {
namespace {

constexpr std::string_view their_index = "fcl_obbrss", their_solver = "nlopt_slsqp";

bool has(std::string_view name, const auto& table) {
  return std::ranges::any_of(table, [&](const auto& entry) { return entry.name == name; });
}

}  // namespace

void measure_paper_steps(SpeedRun& run, const IndexedMesh& on) {
  const Effort& effort = run.settings.effort;
  const std::vector<Motion> motions = contact_motions_of(run, on, {});
  const std::span<const Motion> few =
      std::span(motions).first(std::min(effort.slow_steps, motions.size()));

  run.show("building FCL's tree");
  std::unique_ptr<SpatialIndex> fcl;
  std::string absent;
  if (!has(their_index, indices())) absent = "this build has no FCL";
  if (!has(their_solver, solver_backends())) absent = "this build has no NLopt";
  if (absent.empty()) fcl = make_index(their_index, on.mesh);

  constexpr std::array demands{std::pair{5.0, 60.0}, std::pair{1.0, 25.0}};
  for (const auto& [radius, least] : demands) {
    run.show("the paper's rule, r = " + trimmed(radius) + " mm");
    Stepper ours = paper(on, radius, Form::searching);
    Stepper plain = paper(on, radius, Form::plain);
    std::string remark = disagreement(ours, plain, motions);
    std::optional<MeasuredSide> mine, theirs;
    if (remark.empty()) {
      mine = timed("wide_bvh + active_set", motions.size(), effort.passes,
                   [&](std::size_t i) { ours.ask(motions[i]); });
    }
    if (fcl) {
      Stepper libraries(on.mesh, *fcl, "paper", their_solver, {.radius = radius}, Form::plain);
      const double accuracy = entry_named(their_solver, solver_backends(), "solver").accuracy;
      const std::string theirs_differ = disagreement(libraries, plain, few, accuracy);
      if (theirs_differ.empty()) {
        theirs = timed("FCL's tree + SLSQP", few.size(), 1,
                       [&](std::size_t i) { libraries.ask(few[i]); });
      }
      if (remark.empty()) remark = theirs_differ;
    } else {
      remark = absent;
    }
    if (radius == 5.0) run.baselines.libraries = theirs;
    SpeedRow row = ratio("whole step, paper's rule, r = " + trimmed(radius) + " mm, contact",
                         "(FCL's tree + SLSQP) / ours", at_least(least), theirs, mine);
    row.remark = remark.empty() && !ours.searches() ? plain_form_remark : remark;
    run.add(std::move(row));
  }
}

}  // namespace keepout::app
