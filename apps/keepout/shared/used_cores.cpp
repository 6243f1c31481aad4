// SPDX-License-Identifier: BSD-3-Clause
#include "shared/used_cores.h"

#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <string>

namespace keepout::app {
namespace {

/// Of all threads of this process. [s]
double own_time() {
  std::timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Of everything on all cores since the machine was started. [s]
std::optional<double> all_time() {
  std::ifstream file("/proc/stat");
  std::string name;
  double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, hard = 0, soft = 0, stolen = 0;
  if (!(file >> name >> user >> nice >> system >> idle >> waiting >> hard >> soft >> stolen)) {
    return std::nullopt;
  }
  const double busy = user + nice + system + hard + soft + stolen;
  if (name != "cpu" || busy <= 0.0) return std::nullopt;
  return busy / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

}  // namespace

UsedCores::UsedCores()
    : start_(std::chrono::steady_clock::now()), own_start_(own_time()), all_start_(all_time()) {}

double UsedCores::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double UsedCores::own() const { return (own_time() - own_start_) / seconds(); }

std::optional<double> UsedCores::others() const {
  const std::optional<double> all = all_time();
  if (!all || !all_start_) return std::nullopt;
  // The system counts in hundredths of a second.
  return std::max(0.0, (*all - *all_start_ - (own_time() - own_start_)) / seconds());
}

}  // namespace keepout::app
