// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "keepout/activation/activation_rule.h"
#include "keepout/index/query.h"
#include "keepout/mesh/mesh.h"
#include "keepout/status.h"

namespace keepout {

struct TriangleFromTip;

/// How many planes it takes to allow standing still and nothing else.
inline constexpr std::size_t planes_to_hold_still = 6;

/// Replaces planes by that many, one to each side along the axes.
void hold_still(HalfSpaceBuffer& planes) noexcept;

/// The free space around the tip as one convex polytope, whatever the direction of the motion: for
/// callers with a QP, an MPC or a sampler of their own.
///
/// Every increment d with |d| <= radius that satisfies all planes keeps
///   distance(tip + d, mesh) >= min(clearance, distance(tip, mesh)) - rounding,
/// and as planes and ball are convex and hold d = 0, so does every motion that stays within them,
/// straight or curved. `rounding` is 1e-12 radius + 2e-14 size [length], where size is the largest
/// distance from the tip to a corner of a hit; it does not grow with the distance from the origin.
/// It needs no adjacency, no winding and no closed surface: both sides of a triangle are solid.
///
/// Greedy separation in order of distance: a triangle becomes a plane unless what the ball can
/// reach of it is behind an earlier one. Of its face plane, and of the plane across the way to its
/// closest point, that one is taken which leaves more of what the earlier planes left, counted on
/// fixed probe points in the ball. Planes stand off by a hundredth of the radius, or by a quarter
/// of their room if that is less, so that nearly coplanar neighbors are behind them as well: that
/// costs a hundredth of the volume and saves a quarter of the planes.
///
/// Not thread-safe: one for each thread; the mesh is shared.
class FreePolytope {
 public:
  /// Makes all memory here, for up to `triangles` hits in a call. Throws Error without a mesh.
  FreePolytope(std::shared_ptr<const Mesh> mesh, std::size_t triangles);

  /// Replaces the contents of `planes` by the polytope around `tip`; all offsets are <= 0. Returns
  /// free, or why the planes allow standing still only: touching, invalid_input, over_capacity or
  /// out_of_budget.
  ///
  /// `radius`, `clearance` [length], >= 0. `hits`: all triangles within the ball of radius +
  /// clearance around the tip, in any order; closest points relative to the tip (refine). `planes`
  /// needs room for at least six; with less, a failure leaves it overflowed. `budget`: work is
  /// taken from it.
  ///
  /// The normals, the offsets and their order are the same, bit for bit but for the sign of a zero,
  /// however the triangles are numbered, wound and rotated. Allocates nothing.
  [[nodiscard]] Status around(const Vec3& tip, double radius, double clearance,
                              std::span<const Hit> hits, Budget& budget,
                              HalfSpaceBuffer& planes) noexcept;

 private:
  /// A hit, and what it is sorted by.
  struct Turn {
    double distance;  // [length]
    std::uint32_t hit;
  };
  struct Query;

  Status prepare(Query& query, std::span<const Hit> hits) const noexcept;
  std::span<const Turn> by_distance(std::span<const Hit> hits) noexcept;
  Status separate(const Query& query, std::span<const Hit> hits, Budget& budget,
                  HalfSpaceBuffer& planes) noexcept;
  std::optional<HalfSpace> plane_for(const Query& query, const Hit& hit,
                                     const TriangleFromTip& seen) const noexcept;
  std::size_t probes_left_by(const HalfSpace& plane, double radius) const noexcept;
  void remove_probes(const HalfSpace& plane, double radius) noexcept;

  static constexpr std::size_t probe_count = 256;

  std::shared_ptr<const Mesh> mesh_;
  std::vector<Turn> turns_;
  std::array<Vec3, probe_count> probes_;  // in the unit ball
  std::array<bool, probe_count> is_left_{};
};

}  // namespace keepout
