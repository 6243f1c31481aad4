// SPDX-License-Identifier: BSD-3-Clause
#include "body_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "keepout/index/placement.h"

namespace keepout {
namespace {

constexpr double touching_within = 4.0;  // tolerances

}  // namespace

Status BodyWatch::open(InstrumentStep& result) noexcept {
  Status status = Status::free;
  for (std::size_t b = 0; b < memory_.bodies.size(); ++b) {
    Core core;
    memory_.bodies[b].near.start_cycle(memory_.motion.core(b, 0, core));
    const Status of_body = open_body(b, result);
    if (of_body == Status::over_capacity) return of_body;
    if (!is_ok(of_body)) status = of_body;
  }
  if (!is_ok(status)) return status;
  const bool is_asked = options_.check_sides && memory_.is_watertight;
  return is_asked && was_moved_by_others() ? side() : Status::free;
}

Status BodyWatch::open_body(std::size_t b, InstrumentStep& result) noexcept {
  BodyMemory& body = memory_.bodies[b];
  Budget& budget = memory_.near.budget();
  const double radius = memory_.instrument.bodies()[b].radius;
  const double tolerance = memory_.tolerance;
  if (!look(b, vicinity(b))) return Status::over_capacity;
  double nearest = std::numeric_limits<double>::infinity();
  const double known = radius + options_.margin + options_.band;
  // All at once that the cycle is likely to ask for.
  for (NearTriangle& triangle : body.near.nearer_than(vicinity(b), budget)) {
    if (!(triangle.least < known)) break;
    if (is_worn_out()) return Status::over_capacity;
    body.near.know(triangle, budget);
    nearest = std::min(nearest, triangle.at_start.distance);
  }
  if (is_worn_out()) return Status::over_capacity;
  const double distance = nearest - radius;
  if (nearest <= known && !(result.distance && *result.distance <= distance)) {
    result.distance = distance;
    result.nearest = static_cast<int>(b);
  }
  if (nearest <= touching_within * tolerance) return Status::touching;
  const double room = std::min(options_.band, 0.5 * nearest);
  kept_[b] = certified_distance(distance, body.floor, target(), room, tolerance);
  is_recovering_ = is_recovering_ || is_recovering(b);
  body.floor = kept_[b];
  return Status::free;
}

/// Whether a body is where no step has led it, so that its side is unknown.
bool BodyWatch::was_moved_by_others() const noexcept {
  if (memory_.side_of != memory_.near.mesh().id()) return true;
  for (std::size_t b = 0; b < memory_.bodies.size(); ++b) {
    // So far around its core all is free.
    const double free = 0.5 * (memory_.instrument.bodies()[b].radius + kept_[b]);
    for (const std::uint8_t p : memory_.instrument.points_of(b)) {
      if (!((memory_.motion.at_start()[p] - memory_.ended_at[p]).norm() <= free)) return true;
    }
  }
  return false;
}

/// No core meets the surface, so each is on one side of it, and one point tells which.
Status BodyWatch::side() noexcept {
  for (std::size_t b = 0; b < memory_.bodies.size(); ++b) {
    const std::uint8_t last = memory_.instrument.points_of(b).back();
    const auto placement = place(memory_.near, memory_.motion.at_start()[last]);
    if (!placement || is_worn_out()) return Status::over_capacity;
    if (!placement->is_free) return Status::inside;
  }
  return Status::free;
}

/// From a body's core, what it may be held by: the margin, and as much as it moved at last, unless
/// that was a leap. [length]
double BodyWatch::vicinity(std::size_t b) const noexcept {
  const double reach = std::min(memory_.bodies[b].reach, 4.0 * options_.margin);
  return memory_.instrument.bodies()[b].radius + options_.margin + std::max(options_.band, reach);
}

/// How far a body's points are from where triangles were looked for. [length]
double BodyWatch::moved(std::size_t b) const noexcept {
  const std::span<const Vec3> then = memory_.bodies[b].near.core();
  const std::span<const std::uint8_t> points = memory_.instrument.points_of(b);
  double most = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    most = std::max(most, (memory_.motion.at_start()[points[i]] - then[i]).norm());
  }
  return most;
}

bool BodyWatch::look(std::size_t b, double needed) noexcept {
  BodyMemory& body = memory_.bodies[b];
  if (body.near.radius() >= 0.0 && body.near.radius() - moved(b) >= needed) return true;
  Core core;
  const std::span<const Vec3> now = memory_.motion.core(b, 0, core);
  // Farther where there is little, so that it is looked for seldom; less far where there is much.
  constexpr std::size_t few = 8;
  constexpr std::size_t many = 64;
  const double least = std::max(options_.margin, body.reach);
  body.guard = std::clamp(body.guard, least, std::max(16.0 * options_.margin, 3.0 * body.reach));
  for (const double share : {1.0, 0.125, 0.0}) {
    if (body.near.look(memory_.near, now, needed + share * body.guard)) {
      if (share < 1.0 || body.near.size() > many) body.guard *= 0.5;
      if (body.near.size() < few) body.guard *= 2.0;
      return true;
    }
    if (is_worn_out()) break;
  }
  body.near.forget();
  return false;
}

NearTriangle* BodyWatch::find(std::size_t b, TriangleId id) noexcept {
  if (!look(b, vicinity(b))) return nullptr;
  NearSet& near = memory_.bodies[b].near;
  Budget& budget = memory_.near.budget();
  const std::span<NearTriangle> nearby = near.nearer_than(vicinity(b), budget);
  budget.spend(1 + nearby.size() / 64);
  for (NearTriangle& triangle : nearby) {
    if (triangle.id != id) continue;
    near.know(triangle, budget);
    return &triangle;
  }
  return nullptr;
}

}  // namespace keepout
