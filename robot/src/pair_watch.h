// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>

#include "cycle_memory.h"

namespace keepout {

/// The pairs of a body and a mesh in a cycle: the certified clearance of each, the triangles near
/// it, and the proof that a motion maintains the clearance. Pairs are numbered (p) mesh by mesh:
/// all bodies beside the first mesh, and so on.
///
/// Clearances are distances from the body's surface; the distance from its core is larger by the
/// radius. These are the clearances of a pair, in increasing order:
///
///     demand <= full_demand <= target = margin - band    for proofs: they maintain the demand
///     row_margin = margin                                for rows
///     vicinity - radius                                  for lists of triangles
///
/// If a body is slowed down (slow_down), full_demand and row_margin are larger.
class PairWatch {
 public:
  /// The state of the pairs at the start of a cycle.
  struct Opening {
    Status status = Status::free;  // or the status that forbids all motion
    /// The distance of the nearest body: see InstrumentStep::distance. [length]
    std::optional<double> distance = std::nullopt;
    int body = -1;  // the number of that body
    int mesh = -1;  // the number of the mesh
  };

  /// Precondition of open(): begin_cycle() was called in this cycle for memory.trial_motion and for
  /// the motion of each mesh. Both arguments must outlive this object.
  PairWatch(CycleMemory& memory, const CycleConstants& cycle) noexcept
      : memory_(memory), cycle_(cycle) {}

  /// Measures all pairs. If meshes move, drops each pair whose body touches the mesh, is inside it,
  /// or has too many triangles nearby. The status then stays free, because the other bodies may
  /// have to retreat.
  Opening open() noexcept;

  /// Returns the number of pairs.
  std::size_t size() const noexcept { return memory_.pairs.size(); }
  /// Returns the body of a pair.
  std::size_t body(std::size_t p) const noexcept { return memory_.pairs[p].body; }
  /// Returns the numbers of the body's points.
  std::span<const std::uint8_t> points(std::size_t p) const noexcept {
    return memory_.instrument.points_of(body(p));
  }
  /// Returns the radius of the body. [length]
  double radius(std::size_t p) const noexcept {
    return memory_.instrument.bodies()[body(p)].radius;
  }
  /// Returns the motion of the instrument in the frame of the pair's mesh.
  RelativeMotion& motion(std::size_t p) const noexcept {
    return memory_.meshes[memory_.pairs[p].mesh].motion;
  }

  /// Returns the clearance that this cycle must certify for a pair: its full demand minus the
  /// degradation (F* of docs/joint-space-step.md). [length]
  double demand(std::size_t p) const noexcept { return full_demand(p) - degradation(p); }
  /// Returns the demand without degradation: F, plus the part that slowing_within adds. [length]
  double full_demand(std::size_t p) const noexcept { return memory_.pairs[p].full_demand; }
  /// Returns the clearance that rows demand in this cycle. [length]
  double row_margin(std::size_t p) const noexcept { return memory_.pairs[p].row_margin; }
  /// Returns the length by which demand and rows of a degraded pair are lowered. [length]
  double degradation(std::size_t p) const noexcept {
    return (1.0 - memory_.pairs[p].clearance_fraction) * std::max(full_demand(p), 0.0);
  }
  /// Returns true if any pair is degraded: its clearance fraction is below 1.
  bool is_degraded() const noexcept {
    return std::any_of(memory_.pairs.begin(), memory_.pairs.end(),
                       [](const PairMemory& pair) { return pair.clearance_fraction < 1.0; });
  }
  /// Returns true if the pair is degraded.
  bool is_degraded(std::size_t p) const noexcept {
    return memory_.pairs[p].clearance_fraction < 1.0;
  }
  /// Returns true if motions must be proved clear for the pair.
  bool is_watched(std::size_t p) const noexcept {
    return !memory_.pairs[p].is_dropped && !memory_.pairs[p].is_settled;
  }
  /// Lowers the pair's clearance fraction by at least 1/4, and to at most `most`. The new fraction
  /// is the largest such multiple of 1/4. If it is below 0, or if the full demand is not above 0,
  /// drops the pair instead and remembers the reason.
  void lower_clearance_fraction(std::size_t p, double most, Status reason) noexcept;
  /// Marks a pair as proved for this cycle. Precondition: is_immovable(p).
  void settle(std::size_t p) noexcept { memory_.pairs[p].is_settled = true; }
  /// Returns true if no joint moves the pair's body.
  bool is_immovable(std::size_t p) const noexcept;
  /// Returns why a pair was last dropped, or free. Ignores immovable pairs.
  Status dropped_for() const noexcept { return dropped_for_; }
  /// Lists the degraded pairs. Returns the least clearance fraction of all pairs.
  double list_degraded() noexcept;
  /// Returns the degraded pairs, after list_degraded().
  std::span<const DegradedClearance> degraded() const noexcept { return memory_.degraded.view(); }

  /// Returns true if any body recovers: its certified clearance is below margin - band.
  bool is_recovering() const noexcept { return is_recovering_; }
  /// Returns true if the pair's body recovers.
  bool is_recovering(std::size_t p) const noexcept { return full_demand(p) < target(p); }

  /// Computes the bounds of the trial motion. Call it after each PointMotion::set_trial.
  void update_bounds() noexcept;
  /// Proves as much of the trial motion as possible for one pair, and sets the obstacle. Tries the
  /// normals of the pair's rows first. Returns free, also if there is an obstacle or if the budget
  /// ended in the proof (see Certificate::Obstacle). Returns over_capacity or out_of_budget, with
  /// the obstacle at the start, if the triangles nearby are not known.
  Status judge(std::size_t p, std::span<const Row> rows, Certificate::Obstacle& obstacle) noexcept;
  /// Returns true if a pair that was judged in this cycle has a deficit: see Certificate::owes.
  bool owes() const noexcept { return owes_; }
  /// Returns the largest number of triangles in reach of one body on one motion.
  std::size_t triangles_in_reach() const noexcept { return in_reach_; }

  /// Returns the triangles that may be nearer than `distance` to the body's core at the start of
  /// the cycle, nearest first. Empty if they are not known because the budget or the capacity
  /// ended. Precondition: triangles are known up to `distance`. After open() they are known up to
  /// vicinity(), which includes the row margin of a recovering body. After judge() they are also
  /// known up to radius + demand + the largest displacement of the trial motion. [length]
  std::span<NearTriangle> nearer_than(std::size_t p, double distance) noexcept {
    return memory_.pairs[p].triangles.nearer_than(distance, memory_.budget);
  }
  /// Returns a triangle that may limit the body, with its gap measured. Returns null if it is not
  /// near any more, or if the triangles nearby are not known (judge() then reports the cause).
  NearTriangle* find(std::size_t p, TriangleId id) noexcept;

  /// Stores the certified clearances for the next cycle. For a degraded pair, stores its demand if
  /// that is lower.
  void remember_clearances() noexcept;
  /// Remembers the end of the executed motion, which must be the trial motion.
  void remember_end() noexcept;

 private:
  Status open_pair(std::size_t p, Opening& opening) noexcept;
  void slow_down(std::size_t p, double distance) noexcept;
  void drop(std::size_t p, Status reason) noexcept;
  [[nodiscard]] Status ensure_known(std::size_t p, double needed) noexcept;
  bool has_unknown_side(std::size_t m) noexcept;
  Status find_sides(std::size_t m) noexcept;
  double margin(std::size_t p) const noexcept {
    return memory_.meshes[memory_.pairs[p].mesh].margin(cycle_.options);
  }
  double target(std::size_t p) const noexcept { return margin(p) - cycle_.options.band; }
  double vicinity(std::size_t p) const noexcept;
  double moved(std::size_t p) noexcept;

  CycleMemory& memory_;
  const CycleConstants& cycle_;
  Status dropped_for_ = Status::free;
  bool is_recovering_ = false;
  bool owes_ = false;
  std::size_t in_reach_ = 0;
};

}  // namespace keepout
