// SPDX-License-Identifier: BSD-3-Clause
#include "body_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "keepout/index/query.h"

namespace keepout {
namespace {

constexpr double touching_within = 7.0;  // tolerances; its side is certain beyond six

}  // namespace

Status BodyWatch::open(InstrumentStep& result) noexcept {
  Status status = Status::free;
  for (std::size_t p = 0; p < memory_.pairs.size(); ++p) {
    Core core;
    memory_.pairs[p].near.start_cycle(motion(p).core(memory_.pairs[p].body, 0, core));
    PairMemory& pair = memory_.pairs[p];
    pair.failure = {};
    pair.level = 1.0;
    pair.is_dropped = false;
    pair.is_settled = false;
    Status of_pair = open_pair(p, result);
    if (meshes_move_ && (of_pair == Status::touching || of_pair == Status::over_capacity)) {
      drop(p, of_pair);
      of_pair = Status::free;
    }
    if (of_pair == Status::over_capacity || of_pair == Status::out_of_budget) return of_pair;
    if (!is_ok(of_pair)) status = of_pair;
  }
  for (std::size_t m = 0; m < memory_.meshes.size() && is_ok(status); ++m) {
    const bool is_asked = options_.check_sides && memory_.meshes[m].is_watertight;
    if (is_asked && was_moved_by_others(m)) status = side(m);
  }
  return status;
}

Status BodyWatch::open_pair(std::size_t p, InstrumentStep& result) noexcept {
  PairMemory& pair = memory_.pairs[p];
  const double tolerance = memory_.tolerance;
  if (const Status looked = look(p, vicinity(p)); !is_ok(looked)) return looked;
  double nearest = std::numeric_limits<double>::infinity();
  const double known = radius(p) + own_margin(p) + std::max(options_.band, options_.slowing_within);
  // All at once that the cycle is likely to ask for.
  for (NearTriangle& triangle : pair.near.nearer_than(vicinity(p), memory_.budget)) {
    if (!(triangle.least < known)) break;
    if (is_worn_out()) return Status::out_of_budget;
    pair.near.know(triangle, memory_.budget);
    nearest = std::min(nearest, triangle.at_start.distance);
  }
  if (is_worn_out()) return Status::out_of_budget;
  const double distance = nearest - radius(p);
  if (nearest <= known && !(result.distance && *result.distance <= distance)) {
    result.distance = distance;
    result.nearest = static_cast<int>(pair.body);
    result.nearest_mesh = static_cast<int>(pair.mesh);
  }
  if (nearest <= touching_within * tolerance) return Status::touching;
  // Half of what there is at the most: of its distance, or of its core's where it reaches through.
  const double room = std::min(options_.band, 0.5 * (distance > 0.0 ? distance : nearest));
  pair.kept = certified_distance(distance, pair.floor, target(p), room, tolerance);
  pair.aim = own_margin(p);
  pair.floor = pair.kept;
  is_recovering_ = is_recovering_ || is_recovering(p);
  if (!is_recovering(p)) slow_down(p, distance);
  return Status::free;
}

/// Raises what a body keeps in this cycle, so that it uses up a share only of its way to the margin
/// (the velocity damper of Faverjon and Tournassoud, ICRA 1987): but for what a mesh itself comes
/// on.
void BodyWatch::slow_down(std::size_t p, double distance) noexcept {
  const double left = distance - own_margin(p);
  if (!(left > 0.0 && left < options_.slowing_within)) return;
  const double share = std::min(options_.period / options_.slowing_time, 1.0);
  const double raised = (1.0 - share) * left - motion(p).drift(memory_.pairs[p].body);
  if (!(raised > 0.0)) return;
  memory_.pairs[p].kept += raised;
  memory_.pairs[p].aim += raised;
}

void BodyWatch::close() noexcept {
  for (std::size_t p = 0; p < memory_.pairs.size(); ++p) {
    PairMemory& pair = memory_.pairs[p];
    if (pair.level < 1.0 || pair.is_dropped) pair.floor = std::min(pair.floor, kept(p));
    // A core that is certified to less than three tolerances may have crossed the surface.
    const bool may_have_crossed = !(radius(p) + kept(p) > 3.0 * memory_.tolerance);
    pair.is_side_unknown = pair.is_side_unknown || pair.is_dropped || may_have_crossed;
  }
}

void BodyWatch::lower(std::size_t p, double most, Status reason) noexcept {
  PairMemory& pair = memory_.pairs[p];
  constexpr double quarter = 0.25;
  const double next = quarter * std::floor(std::min(most, pair.level - quarter) / quarter);
  if (pair.kept > 0.0 && next >= 0.0) {
    pair.level = next;
  } else {
    drop(p, reason);
  }
}

void BodyWatch::drop(std::size_t p, Status reason) noexcept {
  memory_.pairs[p].level = 0.0;
  memory_.pairs[p].is_dropped = true;
  memory_.pairs[p].failure = {};
  if (!is_immovable(p)) dropped_for_ = reason;
}

bool BodyWatch::is_immovable(std::size_t p) const noexcept {
  const auto& points = memory_.instrument.points_of(memory_.pairs[p].body);
  return std::all_of(points.begin(), points.end(), [&](std::uint8_t number) {
    return memory_.instrument.points()[number].link == 0;
  });
}

double BodyWatch::name_degraded() noexcept {
  double least = 1.0;
  for (const PairMemory& pair : memory_.pairs) {
    if (pair.level == 1.0) continue;
    least = std::min(least, pair.level);
    memory_.degraded.push(
        {static_cast<int>(pair.body), static_cast<int>(pair.mesh), pair.level, !pair.is_dropped});
  }
  return least;
}

/// Whether a body is where no step has led it beside a mesh, so that its side is unknown.
bool BodyWatch::was_moved_by_others(std::size_t m) noexcept {
  MeshMemory& mesh = memory_.meshes[m];
  if (mesh.side_of != mesh.near->mesh().id()) return true;
  const std::size_t first = m * memory_.instrument.bodies().size();
  for (std::size_t b = 0; b < memory_.instrument.bodies().size(); ++b) {
    if (memory_.pairs[first + b].is_side_unknown) return true;
    // So far around its core all is free.
    const double free = 0.5 * (radius(first + b) + memory_.pairs[first + b].kept);
    for (const std::uint8_t p : memory_.instrument.points_of(b)) {
      if (!((mesh.motion.at_start()[p] - mesh.ended_at[p]).norm() <= free)) return true;
    }
  }
  return false;
}

/// No core meets the surface, so each is on one side of it, and one point tells which.
Status BodyWatch::side(std::size_t m) noexcept {
  MeshMemory& mesh = memory_.meshes[m];
  const std::size_t first = m * memory_.instrument.bodies().size();
  for (std::size_t b = 0; b < memory_.instrument.bodies().size(); ++b) {
    if (memory_.pairs[first + b].is_dropped) continue;
    const std::uint8_t last = memory_.instrument.points_of(b).back();
    mesh.near->budget() = memory_.budget;
    const auto side = find_side(*mesh.near, mesh.motion.at_start()[last]);
    memory_.budget = mesh.near->budget();
    if (!side || is_worn_out()) return memory_.budget.status_at_end();
    if (!side->is_outside && !meshes_move_) return Status::inside;
    if (!side->is_outside) drop(first + b, Status::inside);
    memory_.pairs[first + b].is_side_unknown = false;
  }
  return Status::free;
}

/// From a body's core, what it may be held by: the margin, and as much as it moved at last, unless
/// that was a leap. [length]
double BodyWatch::vicinity(std::size_t p) const noexcept {
  const double reach = std::min(memory_.pairs[p].reach, 4.0 * own_margin(p));
  return radius(p) + own_margin(p) + std::max({options_.band, options_.slowing_within, reach});
}

/// How far a body's points are from where triangles were looked for. [length]
double BodyWatch::moved(std::size_t p) noexcept {
  const std::span<const Vec3> then = memory_.pairs[p].near.core();
  const std::span<const std::uint8_t> points = memory_.instrument.points_of(memory_.pairs[p].body);
  const Vec3* now = motion(p).at_start();
  double most = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    most = std::max(most, (now[points[i]] - then[i]).norm());
  }
  return most;
}

Status BodyWatch::look(std::size_t p, double needed) noexcept {
  PairMemory& pair = memory_.pairs[p];
  if (pair.near.radius() >= 0.0 && pair.near.radius() - moved(p) >= needed) return Status::free;
  Core core;
  const std::span<const Vec3> now = motion(p).core(pair.body, 0, core);
  // Farther where there is little, so that it is looked for seldom; less far where there is much.
  constexpr std::size_t few = 8;
  constexpr std::size_t many = 64;
  const double least = std::max(own_margin(p), pair.reach);
  pair.guard = std::clamp(pair.guard, least, std::max(16.0 * own_margin(p), 3.0 * pair.reach));
  Neighborhood& near = *memory_.meshes[pair.mesh].near;
  for (const double share : {1.0, 0.125, 0.0}) {
    if (pair.near.look(near, now, needed + share * pair.guard, memory_.budget)) {
      if (share < 1.0 || pair.near.size() > many) pair.guard *= 0.5;
      if (pair.near.size() < few) pair.guard *= 2.0;
      return Status::free;
    }
    if (is_worn_out()) break;
  }
  pair.near.forget();
  const bool is_full = near.candidates().overflowed() || pair.near.is_full();
  return is_full ? Status::over_capacity : Status::out_of_budget;
}

NearTriangle* BodyWatch::find(std::size_t p, TriangleId id) noexcept {
  if (!is_ok(look(p, vicinity(p)))) return nullptr;
  NearSet& near = memory_.pairs[p].near;
  const std::span<NearTriangle> nearby = near.nearer_than(vicinity(p), memory_.budget);
  memory_.budget.spend(1 + nearby.size() / 64);
  for (NearTriangle& triangle : nearby) {
    if (triangle.id != id) continue;
    near.know(triangle, memory_.budget);
    return &triangle;
  }
  return nullptr;
}

}  // namespace keepout
