// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/machine_record.h"

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <thread>

#include "bench/parts.h"
#include "keepout/simd_target.h"
#include "keepout/version.h"
#include "machine.h"

namespace keepout::app {
namespace {

/// What one reading of the clock takes, of many.
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
  add(indices());
  add(solver_backends());
  return names;
}

}  // namespace

Machine this_machine() {
  return {.processor = processor(),
          .cores = std::thread::hardware_concurrency(),
          .memory_gib = static_cast<double>(total_memory()) / static_cast<double>(1 << 30),
          .simd = std::string(simd_target()),
          .system = operating_system(),
          .compiler = KEEPOUT_COMPILER,
          .flags = KEEPOUT_FLAGS,
          .build_type = KEEPOUT_BUILD_TYPE,
          .keepout = KEEPOUT_VERSION,
          .libraries = libraries(),
          .clock_ns = clock_cost()};
}

}  // namespace keepout::app
