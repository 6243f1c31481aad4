// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "certificate.h"
#include "cycle_context.h"
#include "pair_memory.h"
#include "row.h"

namespace keepout {

/// The pairs of a body and a mesh in a cycle: the clearance that is certified for each, the
/// triangles near it, and the proof that a motion maintains the clearance. Pairs are numbered mesh
/// by mesh: all bodies beside the first mesh, and so on.
class BodyWatch {
 public:
  /// The context's motion must start before open() is called. Both must outlive it.
  BodyWatch(PairMemories& memory, const CycleContext& context) noexcept
      : memory_(memory), context_(context) {}

  /// Measures all pairs. Sets status, distance and nearest of the result: free, or why nothing may
  /// move. Beside meshes that move, a pair that forbids all motion is dropped instead: the other
  /// bodies may have to retreat.
  void open(InstrumentStep& result) noexcept;

  /// Returns the number of pairs.
  std::size_t size() const noexcept { return memory_.pairs.size(); }
  /// Returns the body of a pair.
  std::size_t body(std::size_t pair) const noexcept { return memory_.pairs[pair].body; }
  /// Returns the numbers of the body's points.
  std::span<const std::uint8_t> points(std::size_t pair) const noexcept {
    return context_.instrument.points_of(body(pair));
  }
  /// Returns the radius of the body. [length]
  double radius(std::size_t pair) const noexcept {
    return context_.instrument.bodies()[body(pair)].radius;
  }
  /// Returns the motion of the instrument in the frame of the pair's mesh.
  RelativeMotion& motion(std::size_t pair) const noexcept {
    return memory_.meshes[memory_.pairs[pair].mesh].motion;
  }

  /// Returns the clearance that this cycle certifies for a pair: the full clearance, less the
  /// degradation. [length]
  double clearance(std::size_t pair) const noexcept {
    return full_clearance(pair) - degradation(pair);
  }
  /// Returns the clearance of a pair that is not degraded: margin - band, or what is left of it.
  /// [length]
  double full_clearance(std::size_t pair) const noexcept {
    return memory_.pairs[pair].full_clearance;
  }
  /// Returns the margin that rows demand in this cycle, beyond the body's radius. [length]
  double row_margin(std::size_t pair) const noexcept { return memory_.pairs[pair].row_margin; }
  /// Returns the length by which clearance and rows of a degraded pair are lowered. [length]
  double degradation(std::size_t pair) const noexcept {
    const PairMemory& one = memory_.pairs[pair];
    return (1.0 - one.clearance_fraction) * std::max(one.full_clearance, 0.0);
  }
  /// Returns true if the pair's clearance is degraded.
  bool is_degraded(std::size_t pair) const noexcept {
    return memory_.pairs[pair].clearance_fraction < 1.0;
  }
  /// Returns true if motions must be proved clear for the pair.
  bool is_watched(std::size_t pair) const noexcept {
    return !memory_.pairs[pair].is_dropped && !memory_.pairs[pair].is_settled;
  }
  /// Lowers the pair's clearance fraction to the next quarter that is at most `most`. If there is
  /// none, drops the pair and remembers the reason.
  void lower(std::size_t pair, double most, Status reason) noexcept;
  /// Notes that the proof of a pair whose body no joint moves is complete.
  void settle(std::size_t pair) noexcept { memory_.pairs[pair].is_settled = true; }
  /// Returns true if no joint moves the pair's body.
  bool is_immovable(std::size_t pair) const noexcept;
  /// Returns why the last pair was dropped whose body a joint moves; free if none was.
  Status dropped_for() const noexcept { return dropped_for_; }
  /// Lists the pairs whose clearance is degraded. Returns the least fraction of all pairs.
  double list_degraded() noexcept;
  /// Returns the list.
  std::span<const DegradedClearance> degraded() const noexcept { return memory_.degraded.view(); }

  /// Returns true if some body is closer than margin - band.
  bool is_recovering() const noexcept { return is_recovering_; }
  /// Returns true if the pair's body is closer than margin - band.
  bool is_recovering(std::size_t pair) const noexcept {
    return memory_.pairs[pair].full_clearance < target(pair);
  }

  /// Starts the proof of another motion of the joints.
  void move() noexcept;
  /// Proves the motion at hand for one pair; the normals of its rows are tried first. Sets the
  /// obstacle to the proof. Returns free, also if there is an obstacle; or over_capacity or
  /// out_of_budget if the triangles nearby are not known: the obstacle is then at the start.
  Status judge(std::size_t pair, std::span<const Row> rows,
               Certificate::Obstacle& obstacle) noexcept;
  /// Returns true if rounding has left less than the clearance of a pair that was judged in this
  /// cycle, so that the end of a motion must be farther off than its start.
  bool owes() const noexcept { return owes_; }
  /// Returns the number of triangles in reach of one body and one motion, at the most.
  std::size_t triangles_in_reach() const noexcept { return in_reach_; }

  /// Returns the triangles that may be nearer than `distance` to the body's core, nearest first.
  std::span<NearTriangle> nearer_than(std::size_t pair, double distance) noexcept {
    return memory_.pairs[pair].triangles.nearer_than(distance, context_.budget);
  }
  /// Returns a triangle that may limit the body, its gap measured; null if it is not near any more,
  /// or if the triangles nearby are not known (then judge() reports why).
  NearTriangle* find(std::size_t pair, TriangleId id) noexcept;

  /// Remembers the end of the executed motion. `context.motion` must be that motion.
  void remember_end() noexcept;
  /// Ends the cycle: lowers the certified clearance of degraded pairs.
  void close() noexcept;

 private:
  Status open_pair(std::size_t pair, InstrumentStep& result) noexcept;
  void slow_down(std::size_t pair, double distance) noexcept;
  void drop(std::size_t pair, Status reason) noexcept;
  [[nodiscard]] Status gather(std::size_t pair, double needed) noexcept;
  Status find_unknown_sides(std::size_t mesh) noexcept;
  bool has_unknown_side(std::size_t mesh) noexcept;
  double margin(std::size_t pair) const noexcept {
    return memory_.meshes[memory_.pairs[pair].mesh].margin(context_.options);
  }
  double target(std::size_t pair) const noexcept { return margin(pair) - context_.options.band; }
  double vicinity(std::size_t pair) const noexcept;
  double moved(std::size_t pair) noexcept;

  PairMemories& memory_;
  const CycleContext& context_;
  Status dropped_for_ = Status::free;
  bool is_recovering_ = false;
  bool owes_ = false;
  std::size_t in_reach_ = 0;
};

}  // namespace keepout
