// SPDX-License-Identifier: BSD-3-Clause
#include "contact_row.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "keepout/activation/facet.h"
#include "keepout/geometry/closest_point.h"

namespace keepout {
namespace {

/// Of the normals from one that is valid to one that is wanted, the last that is valid.
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

std::optional<ContactRow> ContactRows::witness(std::size_t body, const NearTriangle& triangle,
                                               int cell) noexcept {
  const Triangle& corners = *triangle.corners;
  const Gap there = gap_at(body, corners, cell);
  if (!(there.distance > 0.0)) return std::nullopt;
  const CorePoint point = core_point(body, there.contact, cell);
  const Vec3 at = place_of(body, point, 0);
  const ClosestPoint closest = closest_point(corners, at);
  if (!(closest.distance > 0.0)) return std::nullopt;
  const double radius = instrument_.bodies()[body].radius;
  const double level = std::min(radius + margin_, closest.distance) - tolerance_;
  const Vec3 straight = -closest.offset / closest.distance;
  const Vec3 normal = turned_back(straight, there.normal, [&](const Vec3& n) {
    return n.dot(at) - support(corners, n) >= level;
  });
  ContactRow row{.owner = body, .triangle = triangle.id, .point = point, .normal = normal};
  finish(row, at, corners);
  const std::span<const std::uint8_t> points = instrument_.points_of(body);
  const ChainState& chain = motion_.chain_at_start();
  const LinkPoint& first = instrument_.points()[points.front()];
  const LinkPoint& last = instrument_.points()[points.back()];
  const Vec3* places = motion_.at_start();
  for (int k = 1; k <= chain.size(); ++k) {
    double& part = row.gradient[static_cast<std::size_t>(k - 1)];
    if (points.size() > 2) {
      part = normal.dot(chain.linear(k, first.link, at));
    } else {
      part = (1.0 - point.share) * normal.dot(chain.linear(k, first.link, places[points.front()])) +
             point.share * normal.dot(chain.linear(k, last.link, places[points.back()]));
    }
  }
  return row;
}

std::optional<ContactRow> ContactRows::end_point(std::size_t body, std::uint8_t end,
                                                 const NearTriangle& triangle, int cell) noexcept {
  const Triangle& corners = *triangle.corners;
  const Gap there = gap_at(body, corners, cell);
  if (!(triangle.at_start.distance > 0.0)) return std::nullopt;
  const double radius = instrument_.bodies()[body].radius;
  const double level = std::min(radius + margin_, triangle.at_start.distance) - tolerance_;
  const Vec3* places = motion_.at_start();
  const Vec3 wanted = there.distance > 0.0 ? there.normal : triangle.at_start.normal;
  const Vec3 normal = turned_back(triangle.at_start.normal, wanted, [&](const Vec3& n) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint8_t p : instrument_.points_of(body)) {
      least = std::min(least, n.dot(places[p]));
    }
    return least - support(corners, n) >= level;
  });
  ContactRow row{.owner = body, .triangle = triangle.id, .end = end, .normal = normal};
  finish(row, places[end], corners);
  const LinkPoint& point = instrument_.points()[end];
  const ChainState& chain = motion_.chain_at_start();
  for (int k = 1; k <= chain.size(); ++k) {
    row.gradient[static_cast<std::size_t>(k - 1)] =
        normal.dot(chain.linear(k, point.link, places[end]));
  }
  return row;
}

double ContactRows::height_at_end(const ContactRow& row) noexcept {
  const Vec3 at = row.point ? place_of(row.owner, *row.point, PointMotion::cells)
                            : motion_.at(PointMotion::cells)[row.end];
  return row.normal.dot(at) - row.level;
}

Gap ContactRows::gap_at(std::size_t body, const Triangle& corners, int cell) noexcept {
  constexpr std::size_t work_of_turning = 5;  // in looks
  Core core;
  const std::span<const Vec3> points = motion_.core(body, cell, core);
  budget_.spend(work_of_gap(points.size()) + work_of_turning);
  return gap(points, corners);
}

/// Which point of the body's core is at a place at a share of the motion.
CorePoint ContactRows::core_point(std::size_t body, const Vec3& contact, int cell) noexcept {
  const std::span<const std::uint8_t> points = instrument_.points_of(body);
  if (points.size() == 1) return {};
  if (points.size() == 2) {
    const Vec3* places = motion_.at(cell);
    const Vec3 along = places[points[1]] - places[points[0]];
    const double length2 = along.squaredNorm();
    const double share = length2 > 0.0 ? along.dot(contact - places[points[0]]) / length2 : 0.0;
    return {.share = std::clamp(share, 0.0, 1.0)};
  }
  ChainState chain;
  motion_.place(cell, chain);
  const Pose link = chain.link(instrument_.points()[points[0]].link);
  return {.on_link = link.rotation.transpose() * (contact - link.position)};
}

Vec3 ContactRows::place_of(std::size_t body, const CorePoint& point, int cell) noexcept {
  const std::span<const std::uint8_t> points = instrument_.points_of(body);
  const Vec3* places = motion_.at(cell);
  if (points.size() == 1) return places[points[0]];
  if (points.size() == 2) {
    return (1.0 - point.share) * places[points[0]] + point.share * places[points[1]];
  }
  ChainState chain;
  motion_.place(cell, chain);
  return chain.at(instrument_.points()[points[0]].link, point.on_link);
}

void ContactRows::finish(ContactRow& row, const Vec3& at, const Triangle& corners) const noexcept {
  const double radius = instrument_.bodies()[row.owner].radius;
  row.level = support(corners, row.normal) + radius + margin_;
  row.start_height = row.normal.dot(at) - row.level;
  row.bound = std::min(-row.start_height, recovery_);
}

}  // namespace keepout
