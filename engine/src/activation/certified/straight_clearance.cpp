// SPDX-License-Identifier: BSD-3-Clause
#include "straight_clearance.h"

#include "../../geometry/direction_of.h"

namespace keepout {
namespace {

// Far above the most seen, 12. After the last blend the answer is no, which is safe.
constexpr int most_blends = 40;

/// Returns the blend of a falling and a rising normal whose line is level along the motion.
Vec3 level_blend(const Vec3& falling, double fall, const Vec3& rising, double rise) noexcept {
  return unit(rise * falling - fall * rising);
}

}  // namespace

std::optional<Vec3> proof_of_clearance(const PreparedTriangle& prepared, const Vec3& z,
                                       double level, double slack) noexcept {
  Vec3 n_left = prepared.towards_tip();
  Line left = line_of(prepared.at_tip(), z, level);
  if (left.proves_clear(slack)) return n_left;

  const PreparedTriangle::Nearest at_end = prepared.nearest_to(z);
  if (!(at_end.distance - level >= -slack)) return std::nullopt;
  Vec3 n_right = at_end.normal;
  Line right = line_of(at_end, z, level);
  if (right.proves_clear(slack)) return n_right;
  // A distance that only falls or only rises is least at an end, where the level was proven up to
  // rounding. So "no" is the safe answer.
  if (!(left.slope < 0.0 && right.slope > 0.0)) return std::nullopt;

  // The crossing of the two lines bounds the least distance in between from below. The line of the
  // blended normal is a better bound. It is exact if both normals belong to the same corner or
  // edge.
  for (int i = 0; i < most_blends; ++i) {
    const Vec3 blend = level_blend(n_left, left.slope, n_right, right.slope);
    if (separates(blend, prepared.corners(), z, level, slack)) return blend;
    const double t = (left.at_0 - right.at_0) / (right.slope - left.slope);
    const PreparedTriangle::Nearest nearest = prepared.nearest_to(t * z);
    if (!(nearest.distance - level >= -slack)) return std::nullopt;
    const Line line = line_of(nearest, z, level);
    if (line.proves_clear(slack)) return nearest.normal;
    if (line.slope < 0.0) {
      n_left = nearest.normal;
      left = line;
    } else {
      n_right = nearest.normal;
      right = line;
    }
  }
  return std::nullopt;
}

}  // namespace keepout
