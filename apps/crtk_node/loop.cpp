// SPDX-License-Identifier: BSD-3-Clause
#include "loop.h"

#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace keepout::crtk {
namespace {

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void sleep_until(double monotonic) {
  const double whole = std::floor(monotonic);
  const timespec time{static_cast<time_t>(whole), static_cast<long>(1e9 * (monotonic - whole))};
  // After a signal, the caller looks for it.
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr);
}

/// Returns how often this thread has waited for a lock, a file or a clock.
long waits() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nvcsw;
}

double resident_megabytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0.0, resident = 0.0;
  file >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace

std::string LoopReport::text() const {
  char line[300];
  std::snprintf(line, sizeof line,
                "%.1f s: %llu cycles, %llu lost, %llu of them by this program; longest %.0f µs; "
                "resident %.1f MB early, %.1f MB at the end",
                seconds, static_cast<unsigned long long>(cycles),
                static_cast<unsigned long long>(lost), static_cast<unsigned long long>(lost_here),
                1e6 * longest, resident_early, resident);
  return line;
}

LoopReport run_loop(Node& node, double period, double seconds, bool (*stop)()) {
  LoopReport report;
  const double start = seconds_of(CLOCK_MONOTONIC);
  double due = start;
  while (!stop()) {
    const double before = seconds_of(CLOCK_THREAD_CPUTIME_ID);
    const long waits_before = waits();
    node.cycle(seconds_of(CLOCK_REALTIME));
    const double computed = seconds_of(CLOCK_THREAD_CPUTIME_ID) - before;
    const bool is_late_here = computed > period || waits() > waits_before;
    ++report.cycles;
    report.longest = std::max(report.longest, computed);

    due += period;
    const double now = seconds_of(CLOCK_MONOTONIC);
    if (now > due) {
      const double missed = std::floor((now - due) / period);
      due += missed * period;
      report.lost += static_cast<std::uint64_t>(missed);
      if (is_late_here) report.lost_here += static_cast<std::uint64_t>(missed);
    }
    report.seconds = now - start;
    if (seconds > 0.0) {
      if (report.seconds >= seconds) break;
      if (report.resident_early == 0.0 && report.seconds >= 0.1 * seconds) {
        report.resident_early = resident_megabytes();
      }
    }
    sleep_until(due);
  }
  report.resident = resident_megabytes();
  if (report.resident_early == 0.0) report.resident_early = report.resident;
  return report;
}

}  // namespace keepout::crtk
