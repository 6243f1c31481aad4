// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <iostream>
#include <memory>
#include <ostream>
#include <utility>
#include <vector>

#include "bench/bench.h"
#include "bench/speed/process.h"
#include "bench/speed/speed_record.h"
#include "bench/speed/speed_run.h"
#include "keepout/fixtures/real_mesh.h"
#include "record/record.h"
#include "shared/machine.h"
#include "shared/number_text.h"
#include "shared/output_file.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

constexpr Effort thorough{2000, 20'000, 1500, 500, 3, 3, "skull_1m"};
constexpr Effort quick{200, 1000, 100, 100, 1, 1, "bunny"};

constexpr void (*on_the_bunny[])(SpeedRun&, const IndexedMesh&) = {
    measure_sphere_queries, measure_paper_steps, measure_certified_steps, measure_unrelated_states,
    measure_cold_caches,    measure_index_costs, measure_steadiness};

constexpr void (*on_their_own[])(SpeedRun&) = {measure_concave_sphere, measure_first_step,
                                               measure_large_meshes};

/// As far as nobody wishes to stop. Whether it came to the end.
bool measure_all(SpeedRun& run, const StopSignal& stop) {
  {
    const IndexedMesh bunny = with_index(bunny_of(run.triangles));
    for (const auto family : on_the_bunny) {
      if (stop.has_come()) return false;
      family(run, bunny);
      run.progress.advance();
    }
  }
  for (const auto family : on_their_own) {
    if (stop.has_come()) return false;
    family(run);
    run.progress.advance();
  }
  return true;
}

}  // namespace

std::vector<Motion> SpeedRun::contact(const IndexedMesh& on, const MotionKind& kind) const {
  return pressed_motions(on, effort.steps, kind, random());
}

void SpeedRun::add(SpeedRow row) {
  progress.interrupt();
  print_row(out, row);
  out.flush();
  record.rows.push_back(std::move(row));
}

SpeedRow ratio(std::string work, std::string compared, const Demand& demand,
               const Attempt& numerator, const Attempt& denominator) {
  SpeedRow row{.work = std::move(work), .compared = std::move(compared), .demand = demand};
  for (const Attempt* attempt : {&numerator, &denominator}) {
    if (attempt->side) row.sides.push_back(*attempt->side);
    if (row.remark.empty()) row.remark = attempt->refusal;
  }
  if (row.sides.size() == 2) row.figure = row.sides[0].us.p50 / row.sides[1].us.p50;
  return row;
}

Attempt time_steps(std::string name, MotionConstraint& one, MotionConstraint& other,
                   std::span<const Motion> motions, int passes, double accuracy) {
  if (std::string refusal = disagreement(one, other, motions, accuracy); !refusal.empty()) {
    return {.refusal = std::move(refusal)};
  }
  return {
      timed(std::move(name), motions.size(), passes, [&](std::size_t i) { one.step(motions[i]); })};
}

Attempt time_certified(const SpeedRun& run, const IndexedMesh& on, const std::string& name,
                       double margin, std::span<const Motion> motions) {
  MotionConstraint ours = certified(on, margin);
  MotionConstraint plain = certified(queried(on), margin);
  return time_steps(name, ours, plain, motions, run.effort.passes);
}

Attempt in_contact(SpeedRun& run, const IndexedMesh& on, const MotionKind& kind) {
  const std::string name = "margin " + trimmed(kind.clearance) + " mm, motion " +
                           trimmed(kind.shortest) + "-" + trimmed(kind.longest) + " mm";
  run.show("certified, contact, " + name);
  return time_certified(run, on, name, kind.clearance, run.contact(on, kind));
}

int bench_speed(const BenchOptions& options, std::ostream& out) {
  if (options.triangles.size() > 1) throw Error("--speed: give --triangles one size");
  const std::size_t triangles = options.triangles.empty() ? 1'000'000 : options.triangles.front();
  const Effort& effort = options.speed.quick ? quick : thorough;
  OutputFiles outputs = options.files.open({});
  for (const char* fixture : {"bunny", effort.file}) fixture_path(fixture);  // throws if missing

  Progress progress("bench --speed", std::size(on_the_bunny) + std::size(on_their_own));
  SpeedRun run{.options = options.speed,
               .effort = effort,
               .triangles = triangles,
               .progress = progress,
               .out = out,
               .record = {.date = date_now(),
                          .command = options.command,
                          .seed = options.seed,
                          .machine = this_machine(),
                          .mesh = "bunny, " + counted(triangles, "triangle")}};
  const OnCores one(1);
  progress.interrupt();
  print_head(out, run.record);
  out.flush();
  if (!one.holds()) out << "The system does not let this process stay on one core.\n";
  const StopSignal stop;
  run.record.complete = measure_all(run, stop);
  progress.interrupt();
  print_queries(out, run.record);
  print_summary(out, run.record);
  write_record(outputs, record_of(run.record), options.files, std::cerr);
  out << "report: " << options.files.page->string() << '\n';
  return run.record.complete ? EXIT_SUCCESS : exit_interrupted;
}

}  // namespace keepout::app
