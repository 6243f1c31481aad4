// SPDX-License-Identifier: BSD-3-Clause
#include "igtl/igtl.h"

#include <time.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <ostream>

#include "shared/named_mesh.h"
#include "shared/number_text.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

/// Cycles in which the tool was engaged.
struct CycleTally {
  std::size_t cycles = 0;
  std::size_t too_long = 0;  // the work of the loop took longer than a period of processor time
  std::size_t missed = 0;    // periods without a cycle, for any reason
};

double seconds(clockid_t clock) {
  timespec time = {};
  ::clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void sleep_until(double when) {
  timespec time = {};
  time.tv_sec = static_cast<time_t>(when);
  time.tv_nsec = static_cast<long>(1e9 * (when - static_cast<double>(time.tv_sec)));
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr);  // a signal ends it early
}

/// Returns the memory of this process that is in RAM. [MB]
double resident_memory() {
  std::size_t all = 0;
  std::size_t resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return 1e-6 * static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

/// Runs the server, one cycle in each period, until a signal comes. After a delay it does not make
/// up for missed cycles.
CycleTally run(igtl::Server& server, double period, const StopSignal& stop) {
  CycleTally tally;
  double due = seconds(CLOCK_MONOTONIC);
  while (!stop.has_come()) {
    const double work_before = seconds(CLOCK_THREAD_CPUTIME_ID);
    const igtl::Moment moment{.now = seconds(CLOCK_MONOTONIC), .unix = seconds(CLOCK_REALTIME)};
    const bool was_engaged = server.session().engaged();
    server.receive(moment);
    server.tick(moment);
    const double work = seconds(CLOCK_THREAD_CPUTIME_ID) - work_before;
    due += period;
    const double late = seconds(CLOCK_MONOTONIC) - due;
    const auto missed = late > 0.0 ? static_cast<std::size_t>(late / period) : 0;
    due += static_cast<double>(missed) * period;
    if (was_engaged && server.session().engaged()) {
      ++tally.cycles;
      tally.too_long += work > period ? 1 : 0;
      tally.missed += missed;
    }
    sleep_until(due);
  }
  return tally;
}

}  // namespace

int serve_igtl(const IgtlOptions& options, std::ostream& log) {
  const LoadedMesh loaded = load_named_mesh(options.mesh, options.load);
  igtl::ServerOptions settings = options.server;
  settings.constraint.warn = warn_on_stderr;
  igtl::Server server(settings, loaded.mesh);
  const StopSignal stop;
  std::ostream nowhere(nullptr);
  std::ostream& out = is_quiet() ? nowhere : log;
  out << "keepout: guarding '" << settings.device << "' from " << options.mesh.string() << " ("
      << counted(loaded.mesh->triangle_count(), "triangle") << ") on " << settings.address << ':'
      << server.port() << std::endl;
  if (!settings.address.starts_with("127.")) {
    warn_on_stderr("each program that can connect to " + settings.address +
                   " may move the tool, as there is no authentication");
  }
  const double memory = resident_memory();
  const CycleTally tally = run(server, 1.0 / settings.rate, stop);
  const igtl::ServerCounts& counts = server.counts();
  out << "keepout: " << counted(tally.cycles, "cycle") << " while engaged, " << tally.too_long
      << " too long, " << tally.missed << " missed; " << counted(counts.messages, "message") << ", "
      << counts.refused << " refused, " << counts.dropped << " dropped; resident memory "
      << formatted("%.1f MB at the start, %.1f MB at the end", memory, resident_memory())
      << std::endl;
  return EXIT_SUCCESS;
}

}  // namespace keepout::app
