// SPDX-License-Identifier: BSD-3-Clause
#include "shared/machine.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string_view>
#include <thread>

#include "keepout/adapters/index_registry.h"
#include "keepout/simd_target.h"
#include "keepout/solvers/registry.h"
#include "keepout/version.h"

namespace keepout::app {
namespace {

/// Returns the value of a key in one of the system's files; empty if the key is missing.
std::string value_of(const char* file, std::string_view key, std::string_view separator) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t at = line.find(separator);
    if (at != std::string::npos) return line.substr(at + separator.size());
  }
  return {};
}

/// Returns a value of such a file that is given in kibibytes. [bytes]
std::size_t memory_of(const char* file, std::string_view key) {
  std::istringstream text(value_of(file, key, ":"));
  std::size_t count = 0;
  text >> count;
  return count << 10;
}

std::string operating_system() {
  std::string name = value_of("/etc/os-release", "PRETTY_NAME", "=");
  std::erase(name, '"');
  return name.empty() ? "unknown system" : name;
}

/// Returns the mean time of one clock reading. [ns]
double clock_cost() {
  using Clock = std::chrono::steady_clock;
  constexpr int readings = 100'000;
  const Clock::time_point start = Clock::now();
  Clock::time_point last = start;
  for (int i = 0; i < readings; ++i) last = Clock::now();
  return std::chrono::duration<double, std::nano>(last - start).count() / readings;
}

std::vector<std::string> libraries() {
  std::vector<std::string> names = {"Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." +
                                    std::to_string(EIGEN_MAJOR_VERSION) + "." +
                                    std::to_string(EIGEN_MINOR_VERSION)};
  const auto add = [&](const auto& table) {
    for (const auto& entry : table) {
      if (entry.library == nullptr) continue;
      const std::string name = entry.library();
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  };
  add(index_backends());
  add(solver_backends());
  return names;
}

}  // namespace

std::string processor() {
  const std::string name = value_of("/proc/cpuinfo", "model name", ": ");
  return name.empty() ? "unknown processor" : name;
}

Machine this_machine() {
  return {.processor = processor(),
          .cores = std::thread::hardware_concurrency(),
          .memory_gib = static_cast<double>(memory_of("/proc/meminfo", "MemTotal")) /
                        static_cast<double>(1 << 30),
          .simd = std::string(simd_target()),
          .system = operating_system(),
          .compiler = KEEPOUT_COMPILER,
          .flags = KEEPOUT_FLAGS,
          .build_type = KEEPOUT_BUILD_TYPE,
          .keepout = KEEPOUT_VERSION,
          .libraries = libraries(),
          .clock_ns = clock_cost()};
}

std::size_t available_memory() { return memory_of("/proc/meminfo", "MemAvailable"); }

std::size_t peak_memory() { return memory_of("/proc/self/status", "VmHWM"); }

std::string date_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 32> text;
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc)};
}

}  // namespace keepout::app
