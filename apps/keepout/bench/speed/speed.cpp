// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/speed.h"

#include <cstdlib>
#include <memory>
#include <ostream>
#include <utility>
#include <vector>

#include "bench/machine_record.h"
#include "bench/speed/families.h"
#include "bench/speed/speed_files.h"
#include "bench/speed/speed_table.h"
#include "keepout/fixtures/real_mesh.h"
#include "machine.h"
#include "number_text.h"
#include "output_file.h"
#include "report/speed_report.h"
#include "stop_signal.h"

namespace keepout::app {
namespace {

using Family = void (*)(SpeedRun&, const IndexedMesh&);

constexpr Family on_the_bunny[] = {
    measure_sphere_queries, measure_paper_steps, measure_certified_steps, measure_unrelated_states,
    measure_cold_caches,    measure_index_costs, measure_steadiness};

constexpr void (*on_their_own[])(SpeedRun&) = {measure_concave_sphere, measure_first_step,
                                               measure_large_meshes};

/// As far as nobody wishes to stop. Whether it came to the end.
bool measure_all(SpeedRun& run, const StopSignal& stop) {
  {
    const IndexedMesh bunny = with_index(bunny_of(run.settings.triangles));
    for (const Family family : on_the_bunny) {
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

void refuse_overwriting(const SpeedOptions& options) {
  std::vector<NamedPath> outputs{{"--out", options.report}};
  if (options.json) outputs.push_back({"--json", *options.json});
  refuse_shared_files({}, outputs);
}

}  // namespace

int bench_speed(const SpeedOptions& options, std::ostream& out) {
  refuse_overwriting(options);
  for (const std::string& fixture : {std::string("bunny"), options.settings.file}) {
    fixture_path(fixture);  // throws if it is missing
  }
  OutputFile report(options.report);
  const auto json = options.json ? std::make_unique<OutputFile>(*options.json) : nullptr;

  Progress progress("bench --speed", std::size(on_the_bunny) + std::size(on_their_own));
  SpeedRecord record{.date = date_now(),
                     .command = options.command,
                     .seed = options.settings.seed,
                     .machine = this_machine(),
                     .mesh = "bunny, " + counted(options.settings.triangles, "triangle")};
  const Pinned pinned;
  progress.interrupt();
  print_head(out, record);
  out.flush();
  if (!pinned.is_pinned()) out << "The system does not let this process stay on one core.\n";
  SpeedRun run{.settings = options.settings,
               .pinned = pinned,
               .progress = progress,
               .out = out,
               .record = std::move(record)};
  const StopSignal stop;
  run.record.complete = measure_all(run, stop);
  progress.interrupt();
  print_queries(out, run.record);
  print_summary(out, run.record);
  if (json) {
    write_json(json->stream(), run.record);
    json->commit();
  }
  print_speed_report(report.stream(), run.record);
  report.commit();
  out << "report: " << options.report.string() << '\n';
  return run.record.complete ? EXIT_SUCCESS : exit_interrupted;
}

}  // namespace keepout::app
