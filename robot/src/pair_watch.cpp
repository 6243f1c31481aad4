// SPDX-License-Identifier: BSD-3-Clause
#include "pair_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "certified_clearance.h"
#include "keepout/index/query.h"

namespace keepout {

PairWatch::Opening PairWatch::open() noexcept {
  memory_.degraded.clear();
  memory_.budget.spend(work::cycle);
  Opening opening;
  for (std::size_t p = 0; p < size(); ++p) {
    CorePositions core;
    PairMemory& pair = memory_.pairs[p];
    memory_.budget.spend(work::pair);
    pair.triangles.start_listing(motion(p).core_at(pair.body, 0, core));
    pair.moved = pair.triangles.radius() >= 0.0 ? moved(p) : 0.0;
    pair.full_demand = 0.0;
    pair.clearance_fraction = 1.0;
    pair.is_dropped = false;
    pair.is_settled = false;
    Status of_pair = open_pair(p, opening);
    if (cycle_.meshes_move && (of_pair == Status::touching || of_pair == Status::over_capacity)) {
      drop(p, of_pair);
      of_pair = Status::free;
    }
    if (!is_ok(of_pair)) opening.status = of_pair;
    // A body that touches does not end the loop: the distance must be the least of all bodies.
    if (of_pair == Status::over_capacity || of_pair == Status::out_of_budget) return opening;
  }
  for (std::size_t m = 0; m < memory_.meshes.size() && is_ok(opening.status); ++m) {
    const bool is_checked = cycle_.options.check_sides && memory_.meshes[m].is_watertight;
    if (is_checked && has_unknown_side(m)) opening.status = find_sides(m);
  }
  return opening;
}

/// Measures a pair and computes its certified clearance. Returns free, or the status that forbids
/// all motion.
Status PairWatch::open_pair(std::size_t p, Opening& opening) noexcept {
  PairMemory& pair = memory_.pairs[p];
  const InstrumentOptions& options = cycle_.options;
  Budget& budget = memory_.budget;
  if (const Status status = ensure_known(p, vicinity(p)); !is_ok(status)) return status;
  double nearest = std::numeric_limits<double>::infinity();
  const double measured_within =
      radius(p) + margin(p) + std::max(options.band, options.slowing_within);
  // The list is the one that the rows need later. Only triangles that may be the nearest are
  // measured here; the tolerance is for rounding.
  for (NearTriangle& triangle : nearer_than(p, vicinity(p))) {
    if (!(triangle.at_least < std::min(measured_within, nearest + memory_.tolerance))) break;
    if (budget.is_spent()) return Status::out_of_budget;
    pair.triangles.measure(triangle, budget);
    nearest = std::min(nearest, triangle.at_start.distance);
  }
  if (budget.is_spent()) return Status::out_of_budget;
  const double distance = nearest - radius(p);
  if (nearest <= measured_within && !(opening.distance && *opening.distance <= distance)) {
    opening.distance = distance;
    opening.body = static_cast<int>(pair.body);
    opening.mesh = static_cast<int>(pair.mesh);
  }
  if (nearest <= core_touching_within * memory_.tolerance) return Status::touching;
  // A motion may use at most half of the clearance, or half of the core's distance if the body
  // reaches through the surface.
  const double room = std::min(options.band, 0.5 * (distance > 0.0 ? distance : nearest));
  pair.full_demand =
      certified_clearance(distance, pair.certified, target(p), room, memory_.tolerance);
  pair.row_margin = margin(p);
  pair.certified = pair.full_demand;
  if (is_recovering(p)) {
    is_recovering_ = true;
  } else {
    slow_down(p, distance);  // raises only the demand of this cycle
  }
  return Status::free;
}

/// Raises the demand of a pair in this cycle, so that the body may use only a fraction of its
/// distance to the margin. This is the velocity damper of Faverjon and Tournassoud (1987). Does not
/// slow down the approach of a moving mesh.
void PairWatch::slow_down(std::size_t p, double distance) noexcept {
  const InstrumentOptions& options = cycle_.options;
  const double left = distance - margin(p);
  if (!(left > 0.0 && left < options.slowing_within)) return;
  const double fraction = std::min(options.period / options.slowing_time, 1.0);
  const double raised = (1.0 - fraction) * left - motion(p).mesh_displacement_bound(body(p));
  if (!(raised > 0.0)) return;
  memory_.pairs[p].full_demand += raised;
  memory_.pairs[p].row_margin += raised;
}

void PairWatch::remember_clearances() noexcept {
  for (std::size_t p = 0; p < size(); ++p) {
    PairMemory& pair = memory_.pairs[p];
    if (is_degraded(p)) pair.certified = std::min(pair.certified, demand(p));
    const bool crosses = !(radius(p) + demand(p) > crossing_within * memory_.tolerance);
    pair.may_have_crossed = pair.may_have_crossed || pair.is_dropped || crosses;
  }
}

void PairWatch::remember_end() noexcept {
  for (MeshMemory& mesh : memory_.meshes) {
    if (!cycle_.options.check_sides) {
      mesh.sides.forget();
      continue;
    }
    const Vec3* end = mesh.motion.points_in_mesh(PointMotion::last_knot);
    // Notes only the end of each path, because the path is not straight.
    for (std::size_t i = 0; i < memory_.instrument.points().size(); ++i) {
      mesh.sides.note(mesh.neighborhood->mesh(), i, end[i], Vec3::Zero());
    }
  }
}

void PairWatch::lower_clearance_fraction(std::size_t p, double most, Status reason) noexcept {
  PairMemory& pair = memory_.pairs[p];
  constexpr double quarter = 0.25;
  const double next =
      quarter * std::floor(std::min(most, pair.clearance_fraction - quarter) / quarter);
  if (pair.full_demand > 0.0 && next >= 0.0) {
    pair.clearance_fraction = next;
  } else {
    drop(p, reason);
  }
}

void PairWatch::drop(std::size_t p, Status reason) noexcept {
  memory_.pairs[p].clearance_fraction = 0.0;
  memory_.pairs[p].is_dropped = true;
  if (!is_immovable(p)) dropped_for_ = reason;
}

bool PairWatch::is_immovable(std::size_t p) const noexcept {
  return std::all_of(points(p).begin(), points(p).end(), [&](std::uint8_t number) {
    return memory_.instrument.points()[number].link == 0;
  });
}

double PairWatch::list_degraded() noexcept {
  double least = 1.0;
  for (const PairMemory& pair : memory_.pairs) {
    if (pair.clearance_fraction == 1.0) continue;
    least = std::min(least, pair.clearance_fraction);
    memory_.degraded.push({static_cast<int>(pair.body), static_cast<int>(pair.mesh),
                           pair.clearance_fraction, !pair.is_dropped});
  }
  return least;
}

void PairWatch::update_bounds() noexcept {
  for (MeshMemory& mesh : memory_.meshes) mesh.motion.update_bounds();
}

Status PairWatch::judge(std::size_t p, std::span<const Row> rows,
                        Certificate::Obstacle& obstacle) noexcept {
  PairMemory& pair = memory_.pairs[p];
  memory_.budget.spend(work::pair);
  obstacle = {.knot = 0};
  pair.displacement = motion(p).largest_displacement(pair.body);
  const double needed = radius(p) + demand(p) + pair.displacement;
  if (const Status status = ensure_known(p, needed); !is_ok(status)) return status;
  const std::span<NearTriangle> triangles = nearer_than(p, needed);
  obstacle = {};
  if (triangles.empty()) return Status::free;
  in_reach_ = std::max(in_reach_, triangles.size());
  Certificate certificate(memory_.instrument, pair.body, motion(p), pair.triangles, demand(p),
                          memory_.tolerance, memory_.budget);
  for (const Row& row : rows) {
    if (row.owner == p) certificate.try_first(row.normal);
  }
  obstacle = certificate.judge(triangles, pair.displacement);
  owes_ = owes_ || certificate.owes();
  return Status::free;
}

/// Returns true if some body is beside a mesh at a position to which no step has moved it, so that
/// its side is unknown.
bool PairWatch::has_unknown_side(std::size_t m) noexcept {
  MeshMemory& mesh = memory_.meshes[m];
  if (!mesh.sides.is_of(mesh.neighborhood->mesh())) return true;
  const std::size_t bodies = memory_.instrument.bodies().size();
  for (std::size_t p = m * bodies; p < (m + 1) * bodies; ++p) {
    if (memory_.pairs[p].may_have_crossed) return true;
    // No surface is within twice `free` of the core; the other half is slack. So if a point is
    // within `free` of the end of its last step, no surface is between them.
    const double free = 0.5 * (radius(p) + full_demand(p));
    for (const std::uint8_t point : points(p)) {
      if (!mesh.sides.is_near(point, mesh.motion.start_in_mesh()[point], free)) return true;
    }
  }
  return false;
}

/// Classifies each body as inside or outside, by one of its points, because no core meets the
/// surface. If meshes move, drops the bodies inside a mesh. Returns free, or inside, or the status
/// if the search for a side fails.
Status PairWatch::find_sides(std::size_t m) noexcept {
  MeshMemory& mesh = memory_.meshes[m];
  Budget& budget = memory_.budget;
  const std::size_t bodies = memory_.instrument.bodies().size();
  for (std::size_t p = m * bodies; p < (m + 1) * bodies; ++p) {
    if (memory_.pairs[p].is_dropped) continue;
    const auto side = find_side(*mesh.neighborhood, mesh.motion.start_in_mesh()[points(p).back()]);
    if (!side || budget.is_spent()) return budget.failure();
    if (!side->is_outside && !cycle_.meshes_move) return Status::inside;
    if (!side->is_outside) drop(p, Status::inside);
    memory_.pairs[p].may_have_crossed = false;
  }
  return Status::free;
}

/// Returns the distance from a body's core within which triangles may limit it. It is the sum of
/// radius, margin, and the largest of band, slowing_within and the last trial's displacement (up to
/// four margins). [length]
double PairWatch::vicinity(std::size_t p) const noexcept {
  const InstrumentOptions& options = cycle_.options;
  const double moves = std::min(memory_.pairs[p].displacement, 4.0 * margin(p));
  return radius(p) + margin(p) + std::max({options.band, options.slowing_within, moves});
}

/// Returns the distance of a body's points from where they were when triangles were gathered.
/// [length]
double PairWatch::moved(std::size_t p) noexcept {
  const std::span<const Vec3> then = memory_.pairs[p].triangles.gathered_core();
  const Vec3* now = motion(p).start_in_mesh();
  double most = 0.0;
  for (std::size_t i = 0; i < points(p).size(); ++i) {
    most = std::max(most, (now[points(p)[i]] - then[i]).norm());
  }
  return most;
}

/// Gathers triangles, unless all that are nearer than `needed` to a body's core are known. Returns
/// free, or over_capacity or out_of_budget. [length]
Status PairWatch::ensure_known(std::size_t p, double needed) noexcept {
  PairMemory& pair = memory_.pairs[p];
  Budget& budget = memory_.budget;
  if (pair.triangles.radius() >= 0.0 && pair.triangles.radius() - pair.moved >= needed)
    return Status::free;
  CorePositions core;
  const std::span<const Vec3> now = motion(p).core_at(pair.body, 0, core);
  // A search with a wide padding is seldom repeated; one with a narrow padding finds fewer
  // triangles. least <= most, as most >= 3 least.
  constexpr std::size_t few = 8;
  constexpr std::size_t many = 64;
  const double least = std::max(margin(p), pair.displacement);
  const double most = std::max(16.0 * margin(p), 3.0 * pair.displacement);
  pair.padding = std::clamp(pair.padding, least, most);
  Neighborhood& neighborhood = *memory_.meshes[pair.mesh].neighborhood;
  for (const double fraction : {1.0, 0.125, 0.0}) {
    if (pair.triangles.gather(neighborhood, now, needed + fraction * pair.padding, budget)) {
      pair.moved = 0.0;
      if (fraction < 1.0 || pair.triangles.size() > many) pair.padding *= 0.5;
      if (pair.triangles.size() < few) pair.padding *= 2.0;
      return Status::free;
    }
    if (budget.is_spent()) break;
  }
  return budget.is_spent() ? Status::out_of_budget : Status::over_capacity;
}

NearTriangle* PairWatch::find(std::size_t p, TriangleId id) noexcept {
  if (!is_ok(ensure_known(p, vicinity(p)))) return nullptr;
  const std::span<NearTriangle> nearby = nearer_than(p, vicinity(p));
  memory_.budget.spend((1 + nearby.size() / 16) * work::listed_again);
  for (NearTriangle& triangle : nearby) {
    if (triangle.id != id) continue;
    memory_.pairs[p].triangles.measure(triangle, memory_.budget);
    return &triangle;
  }
  return nullptr;
}

}  // namespace keepout
