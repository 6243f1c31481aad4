// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "keepout/index/budget.h"
#include "near_set.h"
#include "relative_motion.h"

namespace keepout {

/// The proof that one body keeps clear of triangles on a motion that is not straight
/// (docs/joint-space-step.md). On a part of the motion, lo to hi, a point's height over a plane is
/// no less than that of a parabola through both ends, bent by as much as the point's second
/// derivative allows. So a plane that has the triangle, grown by what it is due, behind it, and the
/// parabolas of all points of the body before it, proves the body clear on all of that part. Parts
/// that no plane is found for are halved, down to a cell of the grid.
class Certificate {
 public:
  /// A triangle that could not be proven clear, and up to where it was.
  struct Failure {
    int cell = PointMotion::cells;     // proven is the motion up to here; all of it: there is none
    NearTriangle* triangle = nullptr;  // null if there is none, or the budget is spent
  };

  /// For a body on its motion beside a mesh, and what is near it. `kept`: what triangles are to be
  /// kept clear of beyond the radius. All must outlive it. [length]
  Certificate(const Instrument& instrument, std::size_t body, RelativeMotion& motion, NearSet& near,
              double kept, double tolerance, Budget& budget) noexcept;

  /// Tries planes with this normal before others: one that holds the body back.
  void try_first(const Vec3& normal) noexcept;

  /// The first of the triangles to speak against the motion, of equals the first by number.
  /// `reach`: how far the body gets on it (PointMotion::farthest). [length]
  Failure judge(std::span<NearTriangle> triangles, double reach) noexcept;
  /// Returns true if rounding has left less than `kept` of a triangle that was judged, so that the
  /// end of the motion must be farther off than its start.
  bool owes() const noexcept { return owes_; }

 private:
  /// A normal, and the least height of the body over it on the whole motion.
  struct Plane {
    Vec3 normal;
    double least;
  };
  static constexpr std::size_t most_planes = 12;

  Gap gap_at(int cell, const Triangle& corners) noexcept;
  double least_height(const Vec3& normal, int lo, int hi) noexcept;
  bool separates(const Vec3& normal, const NearTriangle& triangle, int lo, int hi) noexcept;
  bool is_covered(const NearTriangle& triangle) const noexcept;
  int proven_until(const NearTriangle& triangle, int lo, const Gap& at_lo, int hi,
                   const Gap& at_hi) noexcept;

  std::size_t body_;
  std::span<const std::uint8_t> points_;
  double radius_;
  RelativeMotion& motion_;
  NearSet& near_;
  double kept_;
  double tolerance_;
  Budget& budget_;
  bool owes_ = false;
  double due_ = 0.0;                 // what the triangle at hand is kept clear of [length]
  int latest_ = PointMotion::cells;  // what is proven farther than that makes no difference
  std::array<Plane, most_planes> planes_;
  std::size_t plane_count_ = 0;
};

}  // namespace keepout
