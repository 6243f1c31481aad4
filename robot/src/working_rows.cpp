// SPDX-License-Identifier: BSD-3-Clause
#include "working_rows.h"

#include <algorithm>
#include <array>
#include <utility>

namespace keepout {
namespace {

constexpr int most_recovery_rows = 4;  // of a body
constexpr double alike = 0.9;          // normals with more than this cosine recover alike
constexpr int most_corrections = 3;    // of a row

}  // namespace

void WorkingRows::start() noexcept {
  memory_.rows.clear();
  std::array<bool, Guide::most> has_row{};  // a guide has one plane where the cycle begins
  for (const WarmRow& warm : memory_.warm) {
    if (warm.owner >= most_pairs && std::exchange(has_row[warm.owner - most_pairs], true)) continue;
    if (const auto row = row_of(warm, 0)) memory_.rows.push(*row);
  }
  for (std::size_t g = 0; g < memory_.guides.size(); ++g) {
    if (!guides_.is_recovering(g) || has_row[g]) continue;
    if (const auto row = guides_.row(g, 0)) memory_.rows.push(*row);
  }
  for (std::size_t p = 0; p < memory_.pairs.size(); ++p) {
    if (watch_.is_watched(p) && watch_.is_recovering(p)) start_recovery(p);
  }
}

/// The row of a body's witness or a guide, where they are at a share of the motion at hand.
std::optional<ContactRow> WorkingRows::row_of(const WarmRow& warm, int cell) noexcept {
  if (warm.owner >= most_pairs) {
    const std::size_t guide = warm.owner - most_pairs;
    const bool is_kept = guide < memory_.guides.size() && !guides_.is_dropped(guide);
    return is_kept ? guides_.row(guide, cell) : std::nullopt;
  }
  if (!watch_.is_watched(warm.owner)) return std::nullopt;
  const NearTriangle* triangle = watch_.find(warm.owner, warm.triangle);
  return triangle == nullptr ? std::nullopt : make_.witness(warm.owner, *triangle, cell);
}

void WorkingRows::start_recovery(std::size_t p) noexcept {
  Budget& budget = memory_.budget;
  const double radius = memory_.instrument.bodies()[memory_.pairs[p].body].radius;
  const double distance = radius + watch_.margin(p);
  const auto nearby = memory_.pairs[p].near.nearer_than(distance, budget);
  for (int count = 0; count < most_recovery_rows && !budget.is_spent(); ++count) {
    budget.spend(1 + nearby.size() * (1 + memory_.rows.size()) / 32);
    // The nearest one that none of the rows leads away from.
    const NearTriangle* nearest = nullptr;
    for (const NearTriangle& triangle : nearby) {
      if (!triangle.is_known || triangle.at_start.distance >= distance) continue;
      if (nearest != nullptr && triangle.at_start.distance >= nearest->at_start.distance) continue;
      const bool is_led =
          std::any_of(memory_.rows.begin(), memory_.rows.end(), [&](const ContactRow& row) {
            return row.owner == p && (row.triangle == triangle.id ||
                                      row.normal.dot(triangle.at_start.normal) > alike);
          });
      if (!is_led) nearest = &triangle;
    }
    if (nearest == nullptr) return;
    const auto row = make_.witness(p, *nearest, 0);
    if (!row) return;
    memory_.rows.push(*row);
  }
}

bool WorkingRows::answer() noexcept {
  bool changed = false;
  for (std::size_t p = 0; p < memory_.pairs.size(); ++p) {
    const Certificate::Failure& failure = memory_.pairs[p].failure;
    if (failure.triangle == nullptr) continue;
    const NearTriangle& triangle = *failure.triangle;
    const std::size_t before = memory_.rows.size();
    add(p, triangle, std::max(failure.cell, 1));
    const bool is_new = memory_.rows.size() > before;
    changed = changed || is_new || correct(p, triangle.id);
  }
  return changed && !memory_.rows.overflowed();
}

bool WorkingRows::answer(std::size_t guide, int cell) noexcept {
  // Planes that touch the region where the motion leaves it, and then where it ends.
  constexpr int most_planes = 4;
  const std::size_t owner = most_pairs + guide;
  const auto planes = std::count_if(memory_.rows.begin(), memory_.rows.end(),
                                    [&](const ContactRow& row) { return row.owner == owner; });
  if (planes < most_planes) {
    const int where = planes == 0 ? std::max(cell, 1) : PointMotion::cells;
    if (const auto row = guides_.row(guide, where)) {
      memory_.rows.push(*row);
      return !memory_.rows.overflowed();
    }
  }
  return correct(owner, no_triangle);
}

/// Witnesses first, then the end points; and then none is missing any more.
void WorkingRows::add(std::size_t p, const NearTriangle& triangle, int cell) noexcept {
  int witnesses = 0;
  bool has_ends = false;
  for (const ContactRow& row : memory_.rows) {
    if (row.owner != p || row.triangle != triangle.id) continue;
    witnesses += row.point.has_value() ? 1 : 0;
    has_ends = has_ends || !row.point.has_value();
  }
  if (witnesses < 2) {
    auto row = make_.witness(p, triangle, cell);
    // A core that touches there shows no normal: then the one as the cycle begins.
    if (!row) row = make_.witness(p, triangle, 0);
    if (row) memory_.rows.push(*row);
  } else if (!has_ends) {
    for (const std::uint8_t end : memory_.instrument.points_of(memory_.pairs[p].body)) {
      if (memory_.instrument.points()[end].link == 0) continue;
      if (const auto row = make_.end_point(p, end, triangle, cell)) memory_.rows.push(*row);
    }
  }
}

/// Adds to a triangle's rows what the straight motion of their points promised, less what the true
/// one kept.
bool WorkingRows::correct(std::size_t owner, TriangleId triangle) noexcept {
  bool changed = false;
  for (ContactRow& row : memory_.rows) {
    if (row.owner != owner || row.triangle != triangle || row.corrections >= most_corrections)
      continue;
    double promised = row.start_height + row.drift;
    for (std::size_t k = 0; k < row.gradient.size(); ++k) {
      promised += row.gradient[k] * memory_.motion.increment()[k];
    }
    const bool is_guide = owner >= most_pairs;
    const double kept = is_guide ? guides_.height_at_end(row) : make_.height_at_end(row);
    const double missing = promised - kept;
    if (!(missing > 0.0)) continue;
    row.correction += missing;
    ++row.corrections;
    changed = true;
  }
  return changed;
}

void WorkingRows::remove(std::size_t owner) noexcept {
  std::size_t left = 0;
  for (const ContactRow& row : memory_.rows) {
    if (row.owner != owner) memory_.rows[left++] = row;
  }
  memory_.rows.shrink(left);
}

std::size_t WorkingRows::hold(std::span<const std::uint32_t> active) noexcept {
  memory_.warm.clear();
  for (const std::uint32_t number : active) {
    if (number >= memory_.rows.size()) continue;
    memory_.warm.push({memory_.rows[number].owner, memory_.rows[number].triangle});
  }
  return memory_.warm.size();
}

void WorkingRows::put_aside() noexcept {
  memory_.earlier_rows.assign(memory_.rows.view());
  memory_.earlier_warm.assign(memory_.warm.view());
}

void WorkingRows::take_back() noexcept {
  memory_.rows.assign(memory_.earlier_rows.view());
  memory_.warm.assign(memory_.earlier_warm.view());
}

bool WorkingRows::turn() noexcept {
  bool changed = false;
  for (ContactRow& row : memory_.rows) {
    if (!holds(row)) continue;
    auto turned = row_of({row.owner, row.triangle}, PointMotion::cells);
    if (!turned) continue;
    turned->correction = row.correction;
    changed = changed || (turned->normal - row.normal).squaredNorm() > 1e-12;
    row = *turned;
  }
  return changed;
}

void WorkingRows::forgive_curvature(double share) noexcept {
  for (ContactRow& row : memory_.rows) {
    row.correction *= share;
    row.corrections = 0;
  }
}

void WorkingRows::remember_all() noexcept {
  memory_.warm.clear();
  for (const ContactRow& row : memory_.rows) {
    if (!holds(row)) memory_.warm.push({row.owner, row.triangle});
  }
}

/// Whether a row of its triangle holds, or is noted already.
bool WorkingRows::holds(const ContactRow& row) const noexcept {
  return std::any_of(memory_.warm.begin(), memory_.warm.end(), [&](const WarmRow& warm) {
    return warm.owner == row.owner && warm.triangle == row.triangle;
  });
}

}  // namespace keepout
