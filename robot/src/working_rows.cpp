// SPDX-License-Identifier: BSD-3-Clause
#include "working_rows.h"

#include <algorithm>
#include <array>
#include <utility>

namespace keepout {
namespace {

constexpr int most_recovery_rows = 4;   // of a body
constexpr double same_direction = 0.9;  // a larger cosine of two normals
constexpr int most_corrections = 3;     // of a row

/// Returns the knot at which to place the plane for an obstacle. At knot 0 nothing has moved yet.
int knot_of_plane(int proved_knot) noexcept { return std::max(proved_knot, 1); }

}  // namespace

void WorkingRows::add_first_rows() noexcept {
  std::array<bool, Guide::most> has_row{};
  for (const WarmRow& warm : memory_.warm) {
    if (is_guide(warm.owner) && std::exchange(has_row[guide_of(warm.owner)], true)) continue;
    if (const auto row = row_of(warm, 0)) memory_.rows.push(*row);
  }
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    if (!guides_.is_recovering(g) || has_row[g]) continue;
    if (const auto row = guides_.row(g, 0)) memory_.rows.push(*row);
  }
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (pairs_.is_watched(p) && pairs_.is_recovering(p)) add_recovery_rows(p);
  }
}

/// Returns the row of a body's contact point or a guide, with the plane at a knot of the motion.
std::optional<Row> WorkingRows::row_of(const WarmRow& warm, int knot) noexcept {
  if (is_guide(warm.owner)) {
    const std::size_t guide = guide_of(warm.owner);
    const bool is_present = guide < guides_.size() && !guides_.is_dropped(guide);
    return is_present ? guides_.row(guide, knot) : std::nullopt;
  }
  if (!pairs_.is_watched(warm.owner)) return std::nullopt;
  const NearTriangle* triangle = pairs_.find(warm.owner, warm.triangle);
  return triangle == nullptr ? std::nullopt : maker_.at_contact(warm.owner, *triangle, knot);
}

void WorkingRows::add_recovery_rows(std::size_t p) noexcept {
  Budget& budget = memory_.budget;
  const double distance = pairs_.radius(p) + pairs_.row_margin(p);
  const auto nearby = pairs_.nearer_than(p, distance);
  for (NearTriangle& triangle : nearby) {
    if (budget.is_spent()) return;
    memory_.pairs[p].triangles.measure(triangle, budget);
  }
  for (int count = 0; count < most_recovery_rows && !budget.is_spent(); ++count) {
    budget.spend((1 + nearby.size() * (1 + memory_.rows.size()) / 32) * work::listed_again);
    // The nearest triangle from which no row pulls the body away.
    const NearTriangle* nearest = nullptr;
    for (const NearTriangle& triangle : nearby) {
      if (triangle.at_start.distance >= distance) continue;
      if (nearest != nullptr && triangle.at_start.distance >= nearest->at_start.distance) continue;
      const bool is_pulled =
          std::any_of(memory_.rows.begin(), memory_.rows.end(), [&](const Row& row) {
            return row.owner == p && (row.triangle == triangle.id ||
                                      row.normal.dot(triangle.at_start.normal) > same_direction);
          });
      if (!is_pulled) nearest = &triangle;
    }
    if (nearest == nullptr) return;
    const auto row = maker_.at_contact(p, *nearest, 0);
    if (!row) return;
    memory_.rows.push(*row);
  }
}

bool WorkingRows::add(std::span<const Certificate::Obstacle> obstacles) noexcept {
  bool changed = false;
  for (std::size_t p = 0; p < obstacles.size(); ++p) {
    const Certificate::Obstacle& obstacle = obstacles[p];
    if (obstacle.triangle == nullptr) continue;
    const NearTriangle& triangle = *obstacle.triangle;
    const bool is_new = add(p, triangle, knot_of_plane(obstacle.knot));
    changed = changed || is_new || correct(p, triangle.id);  // see the header
  }
  return changed && !memory_.rows.overflowed();
}

bool WorkingRows::add(const GuideWatch::Obstacle& obstacle) noexcept {
  // The first plane touches the region where the motion leaves it, the others where the motion
  // ends.
  constexpr int most_planes = 4;
  const std::size_t owner = owner_of_guide(obstacle.guide);
  const auto planes = std::count_if(memory_.rows.begin(), memory_.rows.end(),
                                    [&](const Row& row) { return row.owner == owner; });
  if (planes < most_planes) {
    const int where = planes == 0 ? knot_of_plane(obstacle.knot) : PointMotion::last_knot;
    if (const auto row = guides_.row(obstacle.guide, where)) {
      memory_.rows.push(*row);
      return !memory_.rows.overflowed();
    }
  }
  return correct(owner, no_triangle);
}

/// Adds rows for a triangle: first on two predicted contact points, then on all points of the core.
/// Returns true if any was added.
bool WorkingRows::add(std::size_t p, const NearTriangle& triangle, int knot) noexcept {
  const std::size_t before = memory_.rows.size();
  int contacts = 0;
  bool has_vertices = false;
  for (const Row& row : memory_.rows) {
    if (row.owner != p || row.triangle != triangle.id) continue;
    contacts += row.point.has_value() ? 1 : 0;
    has_vertices = has_vertices || !row.point.has_value();
  }
  if (contacts < 2) {
    auto row = maker_.at_contact(p, triangle, knot);
    // If the core touches there, it has no normal: use the one at the start of the cycle.
    if (!row) row = maker_.at_contact(p, triangle, 0);
    if (row) memory_.rows.push(*row);
  } else if (!has_vertices) {
    maker_.at_vertices(p, triangle, knot, memory_.rows);
  }
  return memory_.rows.size() > before;
}

/// Corrects the rows of a triangle, by the height that the linear motion of their points predicted
/// minus the height of the true motion. Returns true if any row changed.
bool WorkingRows::correct(std::size_t owner, TriangleId triangle) noexcept {
  bool changed = false;
  for (Row& row : memory_.rows) {
    if (row.owner != owner || row.triangle != triangle || row.corrections >= most_corrections)
      continue;
    double predicted = row.start_height + row.drift;
    for (std::size_t k = 0; k < row.gradient.size(); ++k) {
      predicted += row.gradient[k] * memory_.trial_motion.increment()[k];
    }
    const double actual = is_guide(owner) ? guides_.height_at_end(row) : maker_.height_at_end(row);
    const double missing = predicted - actual;
    if (!(missing > 0.0)) continue;
    row.correction += missing;
    ++row.corrections;
    changed = true;
  }
  return changed;
}

void WorkingRows::remove(std::size_t owner) noexcept {
  std::size_t left = 0;
  for (const Row& row : memory_.rows) {
    if (row.owner != owner) memory_.rows[left++] = row;
  }
  memory_.rows.shrink(left);
}

void WorkingRows::remember(std::span<const std::uint32_t> active) noexcept {
  memory_.warm.clear();
  for (const std::uint32_t number : active) {
    if (number >= memory_.rows.size()) continue;
    memory_.warm.push({memory_.rows[number].owner, memory_.rows[number].triangle});
  }
}

void WorkingRows::remember_all() noexcept {
  memory_.warm.clear();
  for (const Row& row : memory_.rows) {
    if (!is_remembered(row)) memory_.warm.push({row.owner, row.triangle});  // each triangle once
  }
}

bool WorkingRows::turn_planes_to_end() noexcept {
  memory_.earlier_rows.assign(memory_.rows.view());
  bool changed = false;
  for (Row& row : memory_.rows) {
    if (!is_remembered(row)) continue;
    auto next = row_of({row.owner, row.triangle}, PointMotion::last_knot);
    if (!next) continue;
    next->correction = row.correction;
    changed = changed || (next->normal - row.normal).squaredNorm() > 1e-12;
    row = *next;
  }
  return changed;
}

void WorkingRows::turn_back() noexcept { memory_.rows.assign(memory_.earlier_rows.view()); }

void WorkingRows::scale_corrections(double factor) noexcept {
  for (Row& row : memory_.rows) {
    row.correction *= factor;
    row.corrections = 0;
  }
}

/// Returns true if a row of the same triangle or guide is remembered.
bool WorkingRows::is_remembered(const Row& row) const noexcept {
  return std::any_of(memory_.warm.begin(), memory_.warm.end(), [&](const WarmRow& warm) {
    return warm.owner == row.owner && warm.triangle == row.triangle;
  });
}

}  // namespace keepout
