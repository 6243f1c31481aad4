// SPDX-License-Identifier: BSD-3-Clause
#include "near_set.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "keepout/activation/prepared_triangle.h"
#include "keepout/robot/instrument.h"

namespace keepout {
namespace {

/// Returns a lower bound of the distance from a segment to a triangle, by the plane across the
/// shortest line to the triangle's middle. It is may_be_near() in double precision.
double least_distance(const Vec3& from, const Vec3& to, const Triangle& corners) noexcept {
  const Vec3 along = to - from;
  const double length2 = along.squaredNorm();
  const Vec3 to_middle = (corners[0] + corners[1] + corners[2]) * (1.0 / 3.0) - from;
  const double fraction =
      length2 > 0.0 ? std::clamp(along.dot(to_middle) / length2, 0.0, 1.0) : 0.0;
  const Vec3 towards = to_middle - fraction * along;
  const double length = towards.norm();
  if (!(length > 0.0)) return 0.0;
  const double nearest = std::min({towards.dot(corners[0] - from), towards.dot(corners[1] - from),
                                   towards.dot(corners[2] - from)});
  const double apart = nearest - std::max(towards.dot(along), 0.0);
  return apart > 0.0 ? apart / length : 0.0;
}

/// Prefetches the triangles that the loop needs soon.
void fetch_ahead(const Mesh& mesh, std::span<const TriangleId> ids, std::size_t i) noexcept {
  constexpr std::size_t corners_ahead = 16;
  constexpr std::size_t vertices_ahead = 8;
  if (i + corners_ahead < ids.size()) __builtin_prefetch(&mesh.corners(ids[i + corners_ahead]));
  if (i + vertices_ahead < ids.size()) {
    for (const VertexId v : mesh.corners(ids[i + vertices_ahead])) {
      __builtin_prefetch(&mesh.vertex(v));
    }
  }
}

}  // namespace

NearSet::NearSet(std::size_t capacity, double beyond) : capacity_(capacity), beyond_(beyond) {
  ids_.reserve(capacity);
  corners_.reserve(capacity);
  blocks_.resize(capacity / NearBlock::lanes + 1);
  found_.reserve(capacity);
  listed_.reserve(capacity);
  listed_in_.reserve(capacity);
  core_.reserve(Instrument::most_points_of_a_body);
  now_.reserve(Instrument::most_points_of_a_body);
  normals_.reserve(capacity);
}

bool NearSet::gather(Neighborhood& near, std::span<const Vec3> core, double radius,
                     Budget& budget) noexcept {
  forget();
  core_.assign(core.begin(), core.end());
  corners_.clear();
  normals_.clear();
  listed_in_.clear();
  start_listing(core);
  TriangleBuffer& candidates = near.candidates();
  candidates.clear();
  near.index().collect_near({from_, to_, radius + beyond_}, candidates);
  budget.spend(work::search);
  budget.spend((candidates.size() / 8) * work::collected);
  // Does not call Budget::mark_overflow(), because the caller may search again within a smaller
  // radius.
  if (candidates.overflowed()) return false;
  budget.spend(candidates.size() * work::candidate);
  if (budget.is_spent()) return false;
  const Mesh& mesh = near.mesh();
  // All triangles that matter touch the ball of this radius about the core.
  size_ = (to_ - from_).norm() + 2.0 * (radius + beyond_) + mesh.longest_edge();
  const NearScreen screen = screen_within(radius);
  const std::span<const TriangleId> found = candidates.view();
  NearBlock block{};
  Triangle corners[NearBlock::lanes];
  for (std::size_t first = 0; first < found.size(); first += NearBlock::lanes) {
    const std::size_t count = std::min(NearBlock::lanes, found.size() - first);
    for (std::size_t lane = 0; lane < count; ++lane) {
      fetch_ahead(mesh, found, first + lane);
      corners[lane] = mesh.triangle(found[first + lane]);
      block.set(lane, corners[lane], core_.front());
    }
    for (std::uint32_t lanes = may_be_near(block, screen); lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
      if (lane >= count) break;
      if (ids_.size() == capacity_) {
        forget();
        return false;
      }
      blocks_[ids_.size() / NearBlock::lanes].set(ids_.size() % NearBlock::lanes, corners[lane],
                                                  core_.front());
      ids_.push_back(found[first + lane]);
      corners_.push_back(corners[lane]);
      normals_.push_back(Vec3::Zero());
      listed_in_.push_back(0);
    }
  }
  radius_ = radius;
  return true;
}

/// Returns the screen for the triangles within `distance` of the core of this listing.
NearScreen NearSet::screen_within(double distance) const noexcept {
  return {from_ - core_.front(), to_ - core_.front(), distance + beyond_, size_};
}

void NearSet::start_listing(std::span<const Vec3> core) noexcept {
  now_.assign(core.begin(), core.end());
  from_ = core.front();
  to_ = core.size() > 1 ? core[1] : core.front();
  listed_.clear();
  ++listing_;
  listed_below_ = -std::numeric_limits<double>::infinity();
}

std::span<NearTriangle> NearSet::nearer_than(double distance, Budget& budget) noexcept {
  if (distance > listed_below_ && !ids_.empty()) {
    found_.clear();
    const NearScreen screen = screen_within(distance);
    budget.spend((1 + ids_.size() / NearBlock::lanes) * work::screened);
    for (std::size_t first = 0; first < ids_.size(); first += NearBlock::lanes) {
      std::uint32_t lanes = may_be_near(blocks_[first / NearBlock::lanes], screen);
      for (; lanes != 0; lanes &= lanes - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(lanes));
        if (i >= ids_.size()) break;
        if (listed_in_[i] == listing_) continue;
        const double height = height_along(normals_[i], now_, corners_[i]);
        if (!(height < distance)) continue;
        const double at_least = std::max(least_distance(from_, to_, corners_[i]) - beyond_, height);
        if (!(at_least < distance)) continue;
        listed_in_[i] = listing_;
        found_.push_back({at_least, ids_[i], static_cast<std::uint32_t>(i)});
      }
    }
    budget.spend(found_.size() * work::listed);
    // All triangles listed before are nearer than these.
    std::sort(found_.begin(), found_.end());
    for (const Found& one : found_) {
      listed_.push_back({.id = one.id,
                         .at_least = one.at_least,
                         .corners = &corners_[one.number],
                         .normal = &normals_[one.number]});
    }
    listed_below_ = distance;
  }
  const auto end =
      std::partition_point(listed_.begin(), listed_.end(),
                           [&](const NearTriangle& one) { return one.at_least < distance; });
  return {listed_.data(), static_cast<std::size_t>(end - listed_.begin())};
}

void NearSet::measure(NearTriangle& triangle, Budget& budget) noexcept {
  if (triangle.is_measured) return;
  budget.spend(work::gap(now_.size()));
  triangle.at_start = gap(now_, *triangle.corners);
  *triangle.normal = triangle.at_start.normal;
  triangle.is_measured = true;
}

}  // namespace keepout
