// SPDX-License-Identifier: BSD-3-Clause
#include "body_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "certified_clearance.h"
#include "keepout/index/query.h"

namespace keepout {

BodyOpening BodyWatch::open() noexcept {
  memory_.degraded.clear();
  BodyOpening opening;
  for (std::size_t p = 0; p < size(); ++p) {
    Core core;
    PairMemory& pair = memory_.pairs[p];
    pair.near.start_cycle(motion(p).core(pair.body, 0, core));
    pair.fraction = 1.0;
    pair.is_dropped = false;
    pair.is_settled = false;
    Status of_pair = open_pair(p, opening);
    if (context_.meshes_move && (of_pair == Status::touching || of_pair == Status::over_capacity)) {
      drop(p, of_pair);
      of_pair = Status::free;
    }
    if (!is_ok(of_pair)) opening.status = of_pair;
    if (of_pair == Status::over_capacity || of_pair == Status::out_of_budget) return opening;
  }
  for (std::size_t m = 0; m < memory_.meshes.size() && is_ok(opening.status); ++m) {
    const bool is_checked = context_.options.check_sides && memory_.meshes[m].is_watertight;
    if (is_checked && is_side_unknown(m)) opening.status = classify(m);
  }
  return opening;
}

Status BodyWatch::open_pair(std::size_t p, BodyOpening& opening) noexcept {
  PairMemory& pair = memory_.pairs[p];
  const InstrumentOptions& options = context_.options;
  Budget& budget = context_.budget;
  if (const Status status = gather(p, vicinity(p)); !is_ok(status)) return status;
  double nearest = std::numeric_limits<double>::infinity();
  const double known = radius(p) + own_margin(p) + std::max(options.band, options.slowing_within);
  // Measure all gaps that the cycle is likely to need.
  for (NearTriangle& triangle : nearer_than(p, vicinity(p))) {
    if (!(triangle.least < known)) break;
    if (budget.is_spent()) return Status::out_of_budget;
    pair.near.know(triangle, budget);
    nearest = std::min(nearest, triangle.at_start.distance);
  }
  if (budget.is_spent()) return Status::out_of_budget;
  const double distance = nearest - radius(p);
  if (nearest <= known && !(opening.distance && *opening.distance <= distance)) {
    opening.distance = distance;
    opening.nearest = static_cast<int>(pair.body);
    opening.nearest_mesh = static_cast<int>(pair.mesh);
  }
  if (nearest <= core_touching_within * context_.tolerance) return Status::touching;
  // At most half of the distance; of the core's distance if the body reaches through the surface.
  const double room = std::min(options.band, 0.5 * (distance > 0.0 ? distance : nearest));
  pair.clearance =
      certified_clearance(distance, pair.certified, target(p), room, context_.tolerance);
  pair.row_margin = own_margin(p);
  pair.certified = pair.clearance;
  is_recovering_ = is_recovering_ || is_recovering(p);
  if (!is_recovering(p)) slow_down(p, distance);
  return Status::free;
}

/// Raises the clearance of a body in this cycle, so that it uses up only a fraction of the way to
/// its margin (the velocity damper of Faverjon and Tournassoud, ICRA 1987). The approach of a mesh
/// that moves is not slowed down.
void BodyWatch::slow_down(std::size_t p, double distance) noexcept {
  const InstrumentOptions& options = context_.options;
  const double left = distance - own_margin(p);
  if (!(left > 0.0 && left < options.slowing_within)) return;
  const double share = std::min(options.period / options.slowing_time, 1.0);
  const double raised = (1.0 - share) * left - motion(p).drift(body(p));
  if (!(raised > 0.0)) return;
  memory_.pairs[p].clearance += raised;
  memory_.pairs[p].row_margin += raised;
}

void BodyWatch::close() noexcept {
  for (std::size_t p = 0; p < size(); ++p) {
    PairMemory& pair = memory_.pairs[p];
    if (is_degraded(p) || pair.is_dropped) pair.certified = std::min(pair.certified, clearance(p));
    const bool may_have_crossed =
        !(radius(p) + clearance(p) > crossing_within * context_.tolerance);
    pair.is_side_unknown = pair.is_side_unknown || pair.is_dropped || may_have_crossed;
  }
}

void BodyWatch::remember_end() noexcept {
  for (MeshMemory& mesh : memory_.meshes) {
    const Vec3* end = mesh.motion.at(PointMotion::cells);
    for (std::size_t i = 0; i < context_.instrument.points().size(); ++i) {
      mesh.sides.note(mesh.near->mesh(), i, end[i], Vec3::Zero());
    }
    if (!context_.options.check_sides) mesh.sides.forget();
  }
}

void BodyWatch::lower(std::size_t p, double most, Status reason) noexcept {
  PairMemory& pair = memory_.pairs[p];
  constexpr double quarter = 0.25;
  const double next = quarter * std::floor(std::min(most, pair.fraction - quarter) / quarter);
  if (pair.clearance > 0.0 && next >= 0.0) {
    pair.fraction = next;
  } else {
    drop(p, reason);
  }
}

void BodyWatch::drop(std::size_t p, Status reason) noexcept {
  memory_.pairs[p].fraction = 0.0;
  memory_.pairs[p].is_dropped = true;
  if (!is_immovable(p)) dropped_for_ = reason;
}

bool BodyWatch::is_immovable(std::size_t p) const noexcept {
  return std::all_of(points(p).begin(), points(p).end(), [&](std::uint8_t number) {
    return context_.instrument.points()[number].link == 0;
  });
}

double BodyWatch::list_degraded() noexcept {
  double least = 1.0;
  for (const PairMemory& pair : memory_.pairs) {
    if (pair.fraction == 1.0) continue;
    least = std::min(least, pair.fraction);
    memory_.degraded.push({static_cast<int>(pair.body), static_cast<int>(pair.mesh), pair.fraction,
                           !pair.is_dropped});
  }
  return least;
}

void BodyWatch::move() noexcept {
  for (MeshMemory& mesh : memory_.meshes) mesh.motion.move();
}

Status BodyWatch::judge(std::size_t p, std::span<const ContactRow> rows,
                        Certificate::Failure& failure) noexcept {
  PairMemory& pair = memory_.pairs[p];
  failure = {};
  pair.displacement = motion(p).farthest(pair.body);
  const double needed = radius(p) + clearance(p) + pair.displacement;
  if (const Status status = gather(p, needed); !is_ok(status)) return status;
  const std::span<NearTriangle> triangles = nearer_than(p, needed);
  if (triangles.empty()) return Status::free;
  in_reach_ = std::max(in_reach_, triangles.size());
  Certificate certificate(context_.instrument, pair.body, motion(p), pair.near, clearance(p),
                          context_.tolerance, context_.budget);
  for (const ContactRow& row : rows) {
    if (row.owner == p) certificate.try_first(row.normal);
  }
  failure = certificate.judge(triangles, pair.displacement);
  owes_ = owes_ || certificate.owes();
  return Status::free;
}

/// Returns true if some body is at a place beside a mesh to which no step has moved it, so that its
/// side is unknown.
bool BodyWatch::is_side_unknown(std::size_t m) noexcept {
  MeshMemory& mesh = memory_.meshes[m];
  if (!mesh.sides.is_of(mesh.near->mesh())) return true;
  const std::size_t bodies = context_.instrument.bodies().size();
  for (std::size_t p = m * bodies; p < (m + 1) * bodies; ++p) {
    if (memory_.pairs[p].is_side_unknown) return true;
    // The core is free within this distance.
    const double free = 0.5 * (radius(p) + full_clearance(p));
    for (const std::uint8_t point : points(p)) {
      if (!mesh.sides.is_near(point, mesh.motion.at_start()[point], free)) return true;
    }
  }
  return false;
}

/// Finds the side of each body by one of its points, as no core meets the surface. Returns free, or
/// inside, or why the side could not be found.
Status BodyWatch::classify(std::size_t m) noexcept {
  MeshMemory& mesh = memory_.meshes[m];
  Budget& budget = context_.budget;
  const std::size_t bodies = context_.instrument.bodies().size();
  for (std::size_t p = m * bodies; p < (m + 1) * bodies; ++p) {
    if (memory_.pairs[p].is_dropped) continue;
    const auto side = find_side(*mesh.near, mesh.motion.at_start()[points(p).back()]);
    if (!side || budget.is_spent()) return budget.status_at_end();
    if (!side->is_outside && !context_.meshes_move) return Status::inside;
    if (!side->is_outside) drop(p, Status::inside);
    memory_.pairs[p].is_side_unknown = false;
  }
  return Status::free;
}

/// Returns the distance from a body's core within which triangles may limit it: the margin, and the
/// displacement of its last motion unless that was a leap. [length]
double BodyWatch::vicinity(std::size_t p) const noexcept {
  const InstrumentOptions& options = context_.options;
  const double moves = std::min(memory_.pairs[p].displacement, 4.0 * own_margin(p));
  return radius(p) + own_margin(p) + std::max({options.band, options.slowing_within, moves});
}

/// Returns the distance of a body's points from where they were when triangles were gathered.
/// [length]
double BodyWatch::moved(std::size_t p) noexcept {
  const std::span<const Vec3> then = memory_.pairs[p].near.core();
  const Vec3* now = motion(p).at_start();
  double most = 0.0;
  for (std::size_t i = 0; i < points(p).size(); ++i) {
    most = std::max(most, (now[points(p)[i]] - then[i]).norm());
  }
  return most;
}

/// Makes sure that all triangles nearer than `needed` to a body's core are known. Returns free, or
/// over_capacity or out_of_budget. [length]
Status BodyWatch::gather(std::size_t p, double needed) noexcept {
  PairMemory& pair = memory_.pairs[p];
  Budget& budget = context_.budget;
  if (pair.near.radius() >= 0.0 && pair.near.radius() - moved(p) >= needed) return Status::free;
  Core core;
  const std::span<const Vec3> now = motion(p).core(pair.body, 0, core);
  // A wide search is seldom repeated; a narrow one finds fewer triangles.
  constexpr std::size_t few = 8;
  constexpr std::size_t many = 64;
  const double least = std::max(own_margin(p), pair.displacement);
  const double most = std::max(16.0 * own_margin(p), 3.0 * pair.displacement);
  pair.padding = std::clamp(pair.padding, least, most);
  Neighborhood& near = *memory_.meshes[pair.mesh].near;
  for (const double share : {1.0, 0.125, 0.0}) {
    if (pair.near.gather(near, now, needed + share * pair.padding, budget)) {
      if (share < 1.0 || pair.near.size() > many) pair.padding *= 0.5;
      if (pair.near.size() < few) pair.padding *= 2.0;
      return Status::free;
    }
    if (budget.is_spent()) break;
  }
  pair.near.forget();
  const bool is_full = near.candidates().overflowed() || pair.near.is_full();
  return is_full ? Status::over_capacity : Status::out_of_budget;
}

NearTriangle* BodyWatch::find(std::size_t p, TriangleId id) noexcept {
  if (!is_ok(gather(p, vicinity(p)))) return nullptr;
  const std::span<NearTriangle> nearby = nearer_than(p, vicinity(p));
  context_.budget.spend(1 + nearby.size() / 64);
  for (NearTriangle& triangle : nearby) {
    if (triangle.id != id) continue;
    memory_.pairs[p].near.know(triangle, context_.budget);
    return &triangle;
  }
  return nullptr;
}

}  // namespace keepout
