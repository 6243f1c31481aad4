// SPDX-License-Identifier: BSD-3-Clause
#include "row_maker.h"

#include <algorithm>
#include <limits>

#include "keepout/activation/prepared_triangle.h"
#include "keepout/geometry/closest_point.h"

namespace keepout {
namespace {

/// Returns the valid normal that is nearest to `wanted` on the arc from `valid`.
template <class IsValid>
Vec3 turned_back(const Vec3& valid, const Vec3& wanted, const IsValid& is_valid) noexcept {
  if (is_valid(wanted)) return wanted;
  constexpr int halvings = 16;
  double good = 0.0;
  double bad = 1.0;
  Vec3 best = valid;
  for (int i = 0; i < halvings; ++i) {
    const double fraction = 0.5 * (good + bad);
    const Vec3 blend = valid + fraction * (wanted - valid);
    const double length = blend.norm();
    const Vec3 n = blend / length;
    if (length > 1e-6 && is_valid(n)) {
      good = fraction;
      best = n;
    } else {
      bad = fraction;
    }
  }
  return best;
}

}  // namespace

std::optional<Row> RowMaker::at_contact(std::size_t pair, const NearTriangle& triangle,
                                        int knot) noexcept {
  const Triangle& corners = *triangle.corners;
  const Gap there = gap_at(pair, triangle, knot);
  if (!(there.distance > 0.0)) return std::nullopt;
  const CorePoint point = core_point(pair, there.contact, knot);
  const Vec3 at = position_of(pair, point, 0);
  const ClosestPoint closest = closest_point(corners, at);
  if (!(closest.distance > 0.0)) return std::nullopt;
  // With this height, the start satisfies the row unless the body is closer than the row margin.
  const double needed_height =
      std::min(pairs_.radius(pair) + pairs_.row_margin(pair), closest.distance) - memory_.tolerance;
  const Vec3 straight = -closest.offset / closest.distance;
  const Vec3 normal = turned_back(straight, there.normal, [&](const Vec3& n) {
    return n.dot(at) - support(corners, n) >= needed_height;
  });
  Row row{.owner = pair, .triangle = triangle.id, .point = point, .normal = normal};
  finish(row, at, corners);
  const std::span<const std::uint8_t> points = pairs_.points(pair);
  const RelativeMotion& motion = pairs_.motion(pair);
  const ChainState& chain = memory_.trial_motion.chain_at_start();
  const LinkPoint& first = memory_.instrument.points()[points.front()];
  const LinkPoint& last = memory_.instrument.points()[points.back()];
  const Vec3* in_world = memory_.trial_motion.points_at_start();
  const Vec3 normal_in_world = motion.direction_in_world_at_start(normal);
  const Vec3 at_in_world = motion.in_world_at_start(at);
  for (int k = 1; k <= chain.size(); ++k) {
    double& entry = row.gradient[static_cast<std::size_t>(k - 1)];
    if (points.size() > 2) {
      entry = normal_in_world.dot(chain.linear(k, first.link, at_in_world));
    } else {
      entry =
          (1.0 - point.fraction) *
              normal_in_world.dot(chain.linear(k, first.link, in_world[points.front()])) +
          point.fraction * normal_in_world.dot(chain.linear(k, last.link, in_world[points.back()]));
    }
  }
  return row;
}

void RowMaker::at_vertices(std::size_t pair, const NearTriangle& triangle, int knot,
                           Buffer<Row>& rows) noexcept {
  const Triangle& corners = *triangle.corners;
  if (!(triangle.at_start.distance > 0.0)) return;
  const Gap there = gap_at(pair, triangle, knot);
  const double needed_height =
      std::min(pairs_.radius(pair) + pairs_.row_margin(pair), triangle.at_start.distance) -
      memory_.tolerance;
  RelativeMotion& motion = pairs_.motion(pair);
  const Vec3* places = motion.start_in_mesh();
  const Vec3 wanted = there.distance > 0.0 ? there.normal : triangle.at_start.normal;
  const Vec3 normal = turned_back(triangle.at_start.normal, wanted, [&](const Vec3& n) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint8_t p : pairs_.points(pair)) least = std::min(least, n.dot(places[p]));
    return least - support(corners, n) >= needed_height;
  });
  const ChainState& chain = memory_.trial_motion.chain_at_start();
  const Vec3 normal_in_world = motion.direction_in_world_at_start(normal);
  for (const std::uint8_t vertex : pairs_.points(pair)) {
    const int link = memory_.instrument.points()[vertex].link;
    if (link == 0) continue;
    Row row{.owner = pair, .triangle = triangle.id, .vertex = vertex, .normal = normal};
    finish(row, places[vertex], corners);
    const Vec3& at_in_world = memory_.trial_motion.points_at_start()[vertex];
    for (int k = 1; k <= chain.size(); ++k) {
      row.gradient[static_cast<std::size_t>(k - 1)] =
          normal_in_world.dot(chain.linear(k, link, at_in_world));
    }
    rows.push(row);
  }
}

double RowMaker::height_at_end(const Row& row) noexcept {
  const Vec3 at = row.point
                      ? position_of(row.owner, *row.point, PointMotion::last_knot)
                      : pairs_.motion(row.owner).points_in_mesh(PointMotion::last_knot)[row.vertex];
  return row.normal.dot(at) - row.offset;
}

Gap RowMaker::gap_at(std::size_t pair, const NearTriangle& triangle, int knot) noexcept {
  memory_.budget.spend(work::row);
  if (knot == 0 && triangle.is_measured) return triangle.at_start;
  CorePositions core;
  const std::span<const Vec3> points = pairs_.motion(pair).core_at(pairs_.body(pair), knot, core);
  memory_.budget.spend(work::gap(points.size()));
  return gap(points, *triangle.corners);
}

/// Returns the point of the body's core that is at `contact` at a knot of the motion.
CorePoint RowMaker::core_point(std::size_t pair, const Vec3& contact, int knot) noexcept {
  const std::span<const std::uint8_t> points = pairs_.points(pair);
  if (points.size() == 1) return {};
  if (points.size() == 2) {
    const Vec3* places = pairs_.motion(pair).points_in_mesh(knot);
    const Vec3 along = places[points[1]] - places[points[0]];
    const double length2 = along.squaredNorm();
    const double fraction = length2 > 0.0 ? along.dot(contact - places[points[0]]) / length2 : 0.0;
    return {.fraction = std::clamp(fraction, 0.0, 1.0)};
  }
  const ChainState& chain = memory_.trial_motion.chain_at(knot);
  const Pose link = chain.link(memory_.instrument.points()[points[0]].link);
  const Vec3 in_world = pairs_.motion(pair).pose_at(knot) * contact;
  return {.on_link = link.rotation.transpose() * (in_world - link.position)};
}

Vec3 RowMaker::position_of(std::size_t pair, const CorePoint& point, int knot) noexcept {
  const std::span<const std::uint8_t> points = pairs_.points(pair);
  const Vec3* places = pairs_.motion(pair).points_in_mesh(knot);
  if (points.size() == 1) return places[points[0]];
  if (points.size() == 2) {
    return (1.0 - point.fraction) * places[points[0]] + point.fraction * places[points[1]];
  }
  const ChainState& chain = memory_.trial_motion.chain_at(knot);
  return pairs_.motion(pair).in_mesh(
      chain.at(memory_.instrument.points()[points[0]].link, point.on_link), knot);
}

/// Fills offset, height, bound and drift, which depend on the normal. `at`: the row's point at the
/// start of the cycle, in the mesh's frame. [length]
void RowMaker::finish(Row& row, const Vec3& at, const Triangle& corners) const noexcept {
  const RelativeMotion& motion = pairs_.motion(row.owner);
  row.offset =
      support(corners, row.normal) + pairs_.radius(row.owner) + pairs_.row_margin(row.owner);
  row.start_height = row.normal.dot(at) - row.offset;
  // At least one tolerance: a body with a deficit must gain a little clearance.
  row.bound = std::min(-row.start_height, std::max(cycle_.options.recovery, memory_.tolerance));
  // Exactly 0 beside a still mesh: rounding could demand a motion that no joint can make.
  if (!motion.is_moving()) return;
  row.drift =
      row.normal.dot(motion.in_mesh(motion.in_world_at_start(at), PointMotion::last_knot) - at);
}

}  // namespace keepout
