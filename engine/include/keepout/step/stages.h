// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <concepts>
#include <cstdint>

namespace keepout {

/// The parts of a step whose time is worth knowing apart.
enum class Stage : std::uint8_t {
  query,       // triangles are looked for; nothing under a rule that searches by itself
  activation,  // the rule begins
  solve        // trials are solved and judged
};

/// What is told as each stage ends.
template <class T>
concept StageObserver = requires(T& observer, Stage stage) {
  requires noexcept(observer.ended(stage));
};

/// Costs nothing.
struct Unobserved {
  /// Takes no note.
  void ended(Stage) const noexcept {}
};

/// The time that each stage took. [ns]
struct StageTimes {
  std::int64_t query = 0;       // Stage::query
  std::int64_t activation = 0;  // Stage::activation
  std::int64_t solve = 0;       // Stage::solve

  /// Of all stages. [ns]
  std::int64_t total() const noexcept { return query + activation + solve; }
};

/// Fills StageTimes. A stage that a failed step does not reach stays at zero.
class StageClock {
 public:
  /// Sets `times` to zero, and starts. They must outlive the clock.
  explicit StageClock(StageTimes& times) noexcept : times_(&times), last_(Clock::now()) {
    times = {};
  }

  /// Adds the time since the start, or the end of the last stage, to a stage's.
  void ended(Stage stage) noexcept {
    const Clock::time_point now = Clock::now();
    const auto spent = std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_).count();
    last_ = now;
    switch (stage) {
      case Stage::query:
        times_->query += spent;
        break;
      case Stage::activation:
        times_->activation += spent;
        break;
      case Stage::solve:
        times_->solve += spent;
        break;
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  StageTimes* times_;
  Clock::time_point last_;
};

}  // namespace keepout
