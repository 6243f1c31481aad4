// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <optional>
#include <string>

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

/// Whether others kept so many of the machine's cores at work that it bears on times.
bool is_busy(const std::optional<double>& others, unsigned cores);

/// A sentence on what others did to the times, or that they did nothing; empty where nobody knows.
std::string others_text(const std::optional<double>& others, unsigned cores);

}  // namespace keepout::app
