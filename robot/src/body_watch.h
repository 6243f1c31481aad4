// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>

#include "cycle_memory.h"

namespace keepout {

/// How the bodies stand to the meshes as a cycle begins, what each is to keep in it, and what is
/// near them. A pair is a body and a mesh.
class BodyWatch {
 public:
  /// The motions' start must be where joints and meshes are. Both must outlive it.
  BodyWatch(CycleMemory& memory, const InstrumentOptions& options, bool meshes_move) noexcept
      : memory_(memory), options_(options), meshes_move_(meshes_move) {}

  /// Looks at all pairs. Returns free, or why nothing may move. The distance goes to the result.
  /// Beside meshes that move, a pair that stops all motion is dropped instead, and its status kept
  /// in `dropped_for`: the other bodies may have to retreat.
  Status open(InstrumentStep& result) noexcept;

  /// The distance that a pair is certified for in this cycle: margin - band, or what is left of it.
  /// [length]
  double kept(std::size_t pair) const noexcept {
    return memory_.pairs[pair].kept - given_way(pair);
  }
  /// The margin that its rows aim at in this cycle, beyond the body's radius. [length]
  double margin(std::size_t pair) const noexcept { return memory_.pairs[pair].aim; }
  /// By how much less than the margin rows aim, as the pair's clearance is degraded. [length]
  double given_way(std::size_t pair) const noexcept {
    const PairMemory& its = memory_.pairs[pair];
    return (1.0 - its.level) * std::max(its.kept, 0.0);
  }
  /// Returns true if motions are to be proved clear for the pair.
  bool is_watched(std::size_t pair) const noexcept {
    return !memory_.pairs[pair].is_dropped && !memory_.pairs[pair].is_settled;
  }
  /// Lowers the pair's level to the next quarter that is no more than `most`; drops the pair, for
  /// that reason, where no level is left.
  void lower(std::size_t pair, double most, Status reason) noexcept;
  /// Takes the pair out of what is certified.
  void drop(std::size_t pair, Status reason) noexcept;
  /// Returns true if no joint moves the pair's body.
  bool is_immovable(std::size_t pair) const noexcept;
  /// Returns why the last pair was dropped whose body joints move; free if none was.
  Status dropped_for() const noexcept { return dropped_for_; }
  /// Returns the least level of all pairs, and puts those below 1 into the memory.
  double name_degraded() noexcept;

  /// Whether some body is closer than margin - band.
  bool is_recovering() const noexcept { return is_recovering_; }
  /// Whether that pair is.
  bool is_recovering(std::size_t pair) const noexcept {
    return memory_.pairs[pair].kept < target(pair);
  }

  /// Makes sure that all triangles nearer than `needed` to a body's core are known. Returns free,
  /// or what was missing: over_capacity or out_of_budget. [length]
  [[nodiscard]] Status look(std::size_t pair, double needed) noexcept;
  /// A triangle that may hold the body, its gap known; null if it is not near any more.
  NearTriangle* find(std::size_t pair, TriangleId id) noexcept;

  /// Notes what was certified, now that the cycle has ended.
  void close() noexcept;

 private:
  Status open_pair(std::size_t pair, InstrumentStep& result) noexcept;
  void slow_down(std::size_t pair, double distance) noexcept;
  Status side(std::size_t mesh) noexcept;
  bool was_moved_by_others(std::size_t mesh) noexcept;
  double radius(std::size_t pair) const noexcept {
    return memory_.instrument.bodies()[memory_.pairs[pair].body].radius;
  }
  /// Of its mesh, before any slowing down. [length]
  double own_margin(std::size_t pair) const noexcept {
    return memory_.meshes[memory_.pairs[pair].mesh].margin(options_);
  }
  RelativeMotion& motion(std::size_t pair) noexcept {
    return memory_.meshes[memory_.pairs[pair].mesh].motion;
  }
  double target(std::size_t pair) const noexcept { return own_margin(pair) - options_.band; }
  double vicinity(std::size_t pair) const noexcept;
  double moved(std::size_t pair) noexcept;
  bool is_worn_out() const noexcept { return memory_.budget.is_spent(); }

  CycleMemory& memory_;
  const InstrumentOptions& options_;
  bool meshes_move_;
  Status dropped_for_ = Status::free;
  bool is_recovering_ = false;
};

}  // namespace keepout
