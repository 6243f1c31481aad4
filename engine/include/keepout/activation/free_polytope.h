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

/// The number of planes that allow only zero motion.
inline constexpr std::size_t planes_to_hold_still = 6;

/// Replaces `planes` by planes that allow only zero motion, one for each direction of each axis.
void hold_still(HalfSpaceBuffer& planes) noexcept;

/// Computes the free space around the tip as one convex polytope, which does not depend on the
/// direction of the motion. For callers with their own quadratic program (QP), model predictive
/// control (MPC) or sampler.
///
/// Every increment d with |d| <= radius that satisfies all planes maintains
/// distance(tip + d, mesh) >= min(clearance, distance(tip, mesh)) - rounding.
/// The same holds along every motion, straight or curved, that stays within planes and ball.
/// `rounding` is 1e-12 radius + 2e-14 size [length], where size is the largest distance from the
/// tip to a corner of a hit. It does not grow with the distance from the origin. The polytope needs
/// no adjacency, no winding and no closed surface: it stays on the tip's side of each triangle.
///
/// Visits the triangles in order of distance. It adds a plane unless the part of the triangle
/// within the ball is already behind an earlier plane. There are two candidates: the face plane,
/// and the plane perpendicular to the segment to the closest point. It adds the one that leaves
/// more of the remaining space. This space is measured by fixed probe points in the ball.
///
/// Planes are nearer to the tip than necessary: by a hundredth of the radius, or by a quarter of
/// the available distance if that is less. Nearly coplanar neighbors are then behind the same
/// plane. This costs a hundredth of the volume and saves a quarter of the planes.
///
/// Not thread-safe: make one for each thread. The mesh may be shared.
class FreePolytope {
 public:
  /// Allocates all memory, for up to `triangles` hits in a call. Throws Error without a mesh.
  FreePolytope(std::shared_ptr<const Mesh> mesh, std::size_t triangles);

  /// Replaces the contents of `planes` by the polytope around `tip`; all offsets are <= 0. Returns
  /// free. If the planes allow only zero motion, returns the cause: touching, invalid_input,
  /// over_capacity or out_of_budget.
  ///
  /// `radius`, `clearance` [length], >= 0. `hits`: all triangles that touch the ball of radius
  /// `radius` + `clearance` around the tip, in any order. Their closest points are relative to the
  /// tip (refine). `planes` needs a capacity of at least planes_to_hold_still; with less, it
  /// overflows on failure. Spends work units of `budget`.
  ///
  /// The normals, the offsets and their order do not depend on how the triangles are numbered and
  /// wound, or which corner is first. They are bitwise identical, except for the sign of a zero.
  /// Allocates nothing.
  [[nodiscard]] Status around(const Vec3& tip, double radius, double clearance,
                              std::span<const Hit> hits, Budget& budget,
                              HalfSpaceBuffer& planes) noexcept;

 private:
  /// A hit and its sort key.
  struct Turn {
    double distance;  // [length]
    std::uint32_t hit;
    std::array<std::uint8_t, 3> corner;  // the order of the triangle's corners
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
