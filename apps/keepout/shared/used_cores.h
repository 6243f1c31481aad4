// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <optional>

namespace keepout::app {

/// How many cores were busy since it was made, in the mean: with this process, and with others.
class UsedCores {
 public:
  UsedCores();

  /// The time since. [s]
  double seconds() const;

  /// Cores that all threads of this process kept busy.
  double own() const;

  /// Cores that other processes kept busy; nothing where the system does not tell.
  std::optional<double> others() const;

 private:
  std::chrono::steady_clock::time_point start_;
  double own_start_;                 // [s]
  std::optional<double> all_start_;  // [s]
};

}  // namespace keepout::app
