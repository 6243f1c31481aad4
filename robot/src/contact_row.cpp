// SPDX-License-Identifier: BSD-3-Clause
#include "contact_row.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "body_watch.h"
#include "keepout/activation/facet.h"
#include "keepout/geometry/closest_point.h"

namespace keepout {
namespace {

/// Returns the normal nearest to `wanted`, on the way from `valid`, that is valid.
template <class IsValid>
Vec3 turned_back(const Vec3& valid, const Vec3& wanted, const IsValid& is_valid) noexcept {
  if (is_valid(wanted)) return wanted;
  constexpr int halvings = 16;
  double good = 0.0;
  double bad = 1.0;
  Vec3 best = valid;
  for (int i = 0; i < halvings; ++i) {
    const double share = 0.5 * (good + bad);
    const Vec3 blend = valid + share * (wanted - valid);
    const double length = blend.norm();
    const Vec3 n = blend / length;
    if (length > 1e-6 && is_valid(n)) {
      good = share;
      best = n;
    } else {
      bad = share;
    }
  }
  return best;
}

}  // namespace

std::optional<ContactRow> ContactRows::at_contact(std::size_t pair, const NearTriangle& triangle,
                                                  int cell) noexcept {
  const Triangle& corners = *triangle.corners;
  const Gap there = gap_at(pair, corners, cell);
  if (!(there.distance > 0.0)) return std::nullopt;
  const CorePoint point = core_point(pair, there.contact, cell);
  const Vec3 at = position_of(pair, point, 0);
  const ClosestPoint closest = closest_point(corners, at);
  if (!(closest.distance > 0.0)) return std::nullopt;
  const double offset = std::min(watch_.radius(pair) + watch_.row_margin(pair), closest.distance) -
                        context_.tolerance;
  const Vec3 straight = -closest.offset / closest.distance;
  const Vec3 normal = turned_back(straight, there.normal, [&](const Vec3& n) {
    return n.dot(at) - support(corners, n) >= offset;
  });
  ContactRow row{.owner = pair, .triangle = triangle.id, .point = point, .normal = normal};
  finish(row, at, corners);
  const std::span<const std::uint8_t> points = watch_.points(pair);
  const RelativeMotion& seen = watch_.motion(pair);
  const ChainState& chain = context_.motion.chain_at_start();
  const LinkPoint& first = context_.instrument.points()[points.front()];
  const LinkPoint& last = context_.instrument.points()[points.back()];
  const Vec3* places = context_.motion.at_start();
  const Vec3 in_world = seen.direction_in_world(normal);
  const Vec3 at_in_world = seen.place_in_world(at);
  for (int k = 1; k <= chain.size(); ++k) {
    double& part = row.gradient[static_cast<std::size_t>(k - 1)];
    if (points.size() > 2) {
      part = in_world.dot(chain.linear(k, first.link, at_in_world));
    } else {
      part = (1.0 - point.fraction) *
                 in_world.dot(chain.linear(k, first.link, places[points.front()])) +
             point.fraction * in_world.dot(chain.linear(k, last.link, places[points.back()]));
    }
  }
  return row;
}

std::optional<ContactRow> ContactRows::at_end_point(std::size_t pair, std::uint8_t end,
                                                    const NearTriangle& triangle,
                                                    int cell) noexcept {
  const Triangle& corners = *triangle.corners;
  const Gap there = gap_at(pair, corners, cell);
  if (!(triangle.at_start.distance > 0.0)) return std::nullopt;
  const double offset =
      std::min(watch_.radius(pair) + watch_.row_margin(pair), triangle.at_start.distance) -
      context_.tolerance;
  RelativeMotion& seen = watch_.motion(pair);
  const Vec3* places = seen.at_start();
  const Vec3 wanted = there.distance > 0.0 ? there.normal : triangle.at_start.normal;
  const Vec3 normal = turned_back(triangle.at_start.normal, wanted, [&](const Vec3& n) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint8_t p : watch_.points(pair)) least = std::min(least, n.dot(places[p]));
    return least - support(corners, n) >= offset;
  });
  ContactRow row{.owner = pair, .triangle = triangle.id, .end = end, .normal = normal};
  finish(row, places[end], corners);
  const LinkPoint& point = context_.instrument.points()[end];
  const ChainState& chain = context_.motion.chain_at_start();
  const Vec3 in_world = seen.direction_in_world(normal);
  for (int k = 1; k <= chain.size(); ++k) {
    row.gradient[static_cast<std::size_t>(k - 1)] =
        in_world.dot(chain.linear(k, point.link, context_.motion.at_start()[end]));
  }
  return row;
}

double ContactRows::height_at_end(const ContactRow& row) noexcept {
  const Vec3 at = row.point ? position_of(row.owner, *row.point, PointMotion::cells)
                            : watch_.motion(row.owner).at(PointMotion::cells)[row.end];
  return row.normal.dot(at) - row.offset;
}

Gap ContactRows::gap_at(std::size_t pair, const Triangle& corners, int cell) noexcept {
  constexpr std::size_t work_of_turning = 5;  // in work units
  Core core;
  const std::span<const Vec3> points = watch_.motion(pair).core(watch_.body(pair), cell, core);
  context_.budget.spend(work_of_gap(points.size()) + work_of_turning);
  return gap(points, corners);
}

/// Returns the point of the body's core that is at `contact` at a cell of the motion.
CorePoint ContactRows::core_point(std::size_t pair, const Vec3& contact, int cell) noexcept {
  const std::span<const std::uint8_t> points = watch_.points(pair);
  if (points.size() == 1) return {};
  if (points.size() == 2) {
    const Vec3* places = watch_.motion(pair).at(cell);
    const Vec3 along = places[points[1]] - places[points[0]];
    const double length2 = along.squaredNorm();
    const double share = length2 > 0.0 ? along.dot(contact - places[points[0]]) / length2 : 0.0;
    return {.fraction = std::clamp(share, 0.0, 1.0)};
  }
  ChainState chain;
  context_.motion.place(cell, chain);
  const Pose link = chain.link(context_.instrument.points()[points[0]].link);
  const Vec3 in_world = watch_.motion(pair).mesh_at(cell) * contact;
  return {.on_link = link.rotation.transpose() * (in_world - link.position)};
}

Vec3 ContactRows::position_of(std::size_t pair, const CorePoint& point, int cell) noexcept {
  const std::span<const std::uint8_t> points = watch_.points(pair);
  const Vec3* places = watch_.motion(pair).at(cell);
  if (points.size() == 1) return places[points[0]];
  if (points.size() == 2) {
    return (1.0 - point.fraction) * places[points[0]] + point.fraction * places[points[1]];
  }
  ChainState chain;
  context_.motion.place(cell, chain);
  return watch_.motion(pair).seen(
      chain.at(context_.instrument.points()[points[0]].link, point.on_link), cell);
}

/// Fills the fields that depend on the normal. `at`: the row's point at the start of the cycle, in
/// the mesh's frame. [length]
void ContactRows::finish(ContactRow& row, const Vec3& at, const Triangle& corners) const noexcept {
  const RelativeMotion& seen = watch_.motion(row.owner);
  row.offset =
      support(corners, row.normal) + watch_.radius(row.owner) + watch_.row_margin(row.owner);
  row.start_height = row.normal.dot(at) - row.offset;
  // At least by a tolerance, which a body owes that rounding has brought closer than is certified.
  row.bound = std::min(-row.start_height, std::max(context_.options.recovery, context_.tolerance));
  // Of a mesh that is still, none at all: no rounding either, which no joint might make up for.
  if (!seen.is_moving()) return;
  row.drift = row.normal.dot(seen.seen(seen.place_in_world(at), PointMotion::cells) - at);
}

}  // namespace keepout
