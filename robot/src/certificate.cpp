// SPDX-License-Identifier: BSD-3-Clause
#include "certificate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "keepout/activation/prepared_triangle.h"
#include "keepout/activation/tolerances.h"

namespace keepout {
namespace {

/// Returns the number of a sub-interval: see Certificate::plane_of_part_.
std::size_t number_of_part(int lo, int hi) noexcept {
  return static_cast<std::size_t>((lo + PointMotion::last_knot) / (hi - lo));
}

}  // namespace

Certificate::Certificate(const Instrument& instrument, std::size_t body, RelativeMotion& motion,
                         NearSet& near, double demand, double tolerance, Budget& budget) noexcept
    : body_(body),
      points_(instrument.points_of(body)),
      radius_(instrument.bodies()[body].radius),
      motion_(motion),
      near_(near),
      demand_(demand),
      tolerance_(tolerance),
      budget_(budget) {}

void Certificate::try_first(const Vec3& normal) noexcept {
  if (plane_count_ == most_planes) return;
  planes_[plane_count_++] = {normal, least_height(normal, 0, PointMotion::last_knot)};
}

Certificate::Obstacle Certificate::judge(std::span<NearTriangle> triangles,
                                         double displacement) noexcept {
  Obstacle first;
  latest_ = PointMotion::last_knot;
  const double out_of_reach = radius_ + demand_ + displacement;
  budget_.spend((triangles.size() / 16) * work::listed_again);
  for (NearTriangle& triangle : triangles) {
    if (triangle.is_measured && triangle.at_start.distance >= out_of_reach) continue;
    budget_.spend(work::judged);
    if (budget_.is_spent()) return {0, nullptr};
    if (is_covered(triangle)) continue;
    near_.measure(triangle, budget_);
    if (triangle.at_start.distance >= out_of_reach) continue;
    // The due clearance is the demand, or the present clearance if that is less (a deficit). With a
    // deficit the motion must end a little farther away, so that rounding does not accumulate. An
    // exempt pair (displacement 0) skips the triangle.
    const double distance = triangle.at_start.distance - radius_;
    due_plus_rounding_ = std::min(demand_, distance + plane_rounding * tolerance_);
    const bool owes = due_plus_rounding_ < demand_;
    if (owes && displacement == 0.0) continue;
    owes_ = owes_ || owes;
    Place start{.knot = 0, .is_known = true, .gap = triangle.at_start};
    Place end{.knot = PointMotion::last_knot};
    const bool gains_too_little = owes && gap_at(end, *triangle.corners).distance <
                                              triangle.at_start.distance + due_gain * tolerance_;
    const int knot = gains_too_little ? 0 : proved_until(triangle, start, end);
    if (budget_.is_spent()) return {0, nullptr};
    if (knot > latest_ || knot == PointMotion::last_knot) continue;
    if (knot == latest_ && first.triangle != nullptr && first.triangle->id < triangle.id) continue;
    latest_ = knot;
    first = {knot, &triangle};
  }
  return first;
}

const Gap& Certificate::gap_at(Place& place, const Triangle& corners) noexcept {
  if (place.is_known) return place.gap;
  budget_.spend(work::gap(points_.size()));
  CorePositions core;
  place.gap = gap(motion_.core_at(body_, place.knot, core), corners);
  place.is_known = true;
  return place.gap;
}

/// Returns the least height of the body's core along a normal on a sub-interval of the motion.
double Certificate::least_height(const Vec3& normal, int lo, int hi) noexcept {
  const Vec3* at_lo = motion_.points_in_mesh(lo);
  const Vec3* at_hi = motion_.points_in_mesh(hi);
  const double span = static_cast<double>(hi - lo) / PointMotion::last_knot;
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint8_t p : points_) {
    const double first = normal.dot(at_lo[p]);
    const double last = normal.dot(at_hi[p]);
    const double bend = motion_.bend(p) * span * span;
    double height = std::min(first, last);
    const double rest = 0.5 * bend - std::abs(last - first);
    if (rest > 0.0) height -= rest * rest / (2.0 * bend);
    least = std::min(least, height);
  }
  return least;
}

bool Certificate::separates(const Vec3& normal, const NearTriangle& triangle, int lo,
                            int hi) noexcept {
  budget_.spend(work::separation);
  const double least = least_height(normal, lo, hi);
  const double behind = support(*triangle.corners, normal);
  if (!(least - behind >= radius_ + due_plus_rounding_ - plane_rounding * tolerance_)) return false;
  const std::size_t part = number_of_part(lo, hi);
  plane_of_part_[part] = {normal, least};
  has_plane_[part] = true;
  const bool is_whole = part == 1;
  if (is_whole && plane_count_ < most_planes) planes_[plane_count_++] = {normal, least};
  return true;
}

bool Certificate::is_covered(const NearTriangle& triangle) const noexcept {
  const double needed = radius_ + demand_ - plane_rounding * tolerance_;
  return std::any_of(planes_.begin(), planes_.begin() + plane_count_, [&](const Plane& plane) {
    return plane.least - support(*triangle.corners, plane.normal) >= needed;
  });
}

/// Returns true if the plane that last proved the sub-interval proves it for this triangle, too.
bool Certificate::is_covered(const NearTriangle& triangle, int lo, int hi) const noexcept {
  const std::size_t part = number_of_part(lo, hi);
  if (!has_plane_[part]) return false;
  const Plane& plane = plane_of_part_[part];
  const double height = plane.least - support(*triangle.corners, plane.normal);
  return height >= radius_ + due_plus_rounding_ - plane_rounding * tolerance_;
}

/// Like is_covered(), but also by planes of its halves, of their halves, and so on.
bool Certificate::is_covered_in_parts(const NearTriangle& triangle, int lo, int hi) const noexcept {
  if (is_covered(triangle, lo, hi)) return true;
  if (hi - lo == 1) return false;
  const int middle = (lo + hi) / 2;
  return is_covered_in_parts(triangle, lo, middle) && is_covered_in_parts(triangle, middle, hi);
}

/// Tries to prove the sub-interval by planes that are known, and by the gap at lo.
bool Certificate::is_proved_from(const NearTriangle& triangle, Place& lo,
                                 const Place& hi) noexcept {
  if (is_covered(triangle, lo.knot, hi.knot)) return true;
  const auto separates_at = [&](const Gap& gap) {
    return gap.distance > 0.0 && separates(gap.normal, triangle, lo.knot, hi.knot);
  };
  if (hi.is_known && separates_at(hi.gap)) return true;
  const Gap& at_lo = gap_at(lo, *triangle.corners);
  const Vec3* from = motion_.points_in_mesh(lo.knot);
  const Vec3* to = motion_.points_in_mesh(hi.knot);
  const double span = static_cast<double>(hi.knot - lo.knot) / PointMotion::last_knot;
  double reach = 0.0;
  for (const std::uint8_t p : points_) {
    reach = std::max(reach, (to[p] - from[p]).norm() + motion_.bend(p) * span * span / 8.0);
  }
  // This proof uses no plane, so it demands the 2 tolerances for rounding in full.
  return at_lo.distance - reach >= radius_ + due_plus_rounding_ || separates_at(at_lo);
}

/// Like is_proved_from(), which has failed, but by the gap at hi, and by a plane between those of
/// both ends.
bool Certificate::is_proved_to(const NearTriangle& triangle, const Place& lo, Place& hi) noexcept {
  const bool was_tried = hi.is_known;
  const Gap& at_hi = gap_at(hi, *triangle.corners);
  if (!(lo.gap.distance > 0.0 && at_hi.distance > 0.0)) return false;
  if (!was_tried && separates(at_hi.normal, triangle, lo.knot, hi.knot)) return true;
  const Vec3 sum = lo.gap.normal + at_hi.normal;
  const double length = sum.norm();
  return length > 1e-3 && separates(sum / length, triangle, lo.knot, hi.knot);
}

/// Returns the last knot up to which the sub-interval from lo to hi is proved.
int Certificate::proved_until(const NearTriangle& triangle, Place& lo, Place& hi) noexcept {
  if (lo.knot > latest_ || budget_.is_spent()) return lo.knot;
  if (is_proved_from(triangle, lo, hi)) return hi.knot;
  Place middle{.knot = (lo.knot + hi.knot) / 2};
  // Planes that are known cost less than a gap.
  if (hi.knot - lo.knot > 1 && is_covered_in_parts(triangle, lo.knot, middle.knot)) {
    if (is_covered_in_parts(triangle, middle.knot, hi.knot)) return hi.knot;
    return proved_until(triangle, middle, hi);
  }
  if (hi.knot - lo.knot == PointMotion::last_knot) {
    // If another triangle ends the proof earlier, only the sub-interval before its knot matters.
    if (latest_ < middle.knot) {
      Place until{.knot = static_cast<int>(std::bit_ceil(static_cast<unsigned>(latest_) + 1U))};
      if (is_proved_from(triangle, lo, until) || is_proved_to(triangle, lo, until)) {
        return until.knot;
      }
    }
  }
  if (is_proved_to(triangle, lo, hi)) return hi.knot;
  if (hi.knot - lo.knot == 1) return lo.knot;
  const int first = proved_until(triangle, lo, middle);
  if (first < middle.knot) return first;
  return proved_until(triangle, middle, hi);
}

}  // namespace keepout
