// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "cycle_memory.h"

namespace keepout {

/// How the bodies stand as a cycle begins, what each is to keep in it, and what is near them.
class BodyWatch {
 public:
  /// The motion's start must be where the joints are. Both must outlive it.
  BodyWatch(CycleMemory& memory, const InstrumentOptions& options) noexcept
      : memory_(memory), options_(options) {}

  /// Looks at all bodies: free, or why nothing may move. The distance goes to the result.
  Status open(InstrumentStep& result) noexcept;

  /// The distance that a body is certified for in this cycle: margin - band, or what is left of it.
  /// [length]
  double kept(std::size_t body) const noexcept { return kept_[body]; }
  /// Whether some body is closer than margin - band.
  bool is_recovering() const noexcept { return is_recovering_; }
  /// Whether that body is.
  bool is_recovering(std::size_t body) const noexcept { return kept_[body] < target(); }

  /// Makes sure that all triangles nearer than that to a body's core are known. False: there is no
  /// room, or no work left. [length]
  [[nodiscard]] bool look(std::size_t body, double needed) noexcept;
  /// A triangle that may hold the body, its gap known; null if it is not near any more.
  NearTriangle* find(std::size_t body, TriangleId id) noexcept;

 private:
  Status open_body(std::size_t body, InstrumentStep& result) noexcept;
  Status side() noexcept;
  bool was_moved_by_others() const noexcept;
  double vicinity(std::size_t body) const noexcept;
  double moved(std::size_t body) const noexcept;
  double target() const noexcept { return options_.margin - options_.band; }
  bool is_worn_out() const noexcept { return memory_.near.budget().is_spent(); }

  CycleMemory& memory_;
  const InstrumentOptions& options_;
  std::array<double, Instrument::most_bodies> kept_{};  // of each body in this cycle [length]
  bool is_recovering_ = false;
};

}  // namespace keepout
