// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/query.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "keepout/error.h"

namespace keepout {

void refine(const Mesh& mesh, const Ball& ball, std::span<const TriangleId> candidates,
            HitBuffer& hits) noexcept {
  for (const TriangleId t : candidates) {
    const ClosestPoint closest = closest_point(mesh.triangle(t), ball.center);
    if (closest.distance <= ball.radius) hits.push({t, closest});
  }
  const auto is_before = [](const Hit& a, const Hit& b) { return a.triangle < b.triangle; };
  if (std::is_sorted(hits.begin(), hits.end(), is_before)) return;
  std::sort(hits.begin(), hits.end(), is_before);
}

namespace {

std::size_t room_for(const Mesh* mesh, const SpatialIndex* index, std::size_t asked) {
  if (mesh == nullptr || index == nullptr) {
    throw Error("a query needs a mesh and an index, but one of them is null");
  }
  if (&index->mesh() != mesh) {
    throw Error("the index is of another mesh: build it on this one, or refit it to this one");
  }
  return std::min(asked, mesh->triangle_count());
}

}  // namespace

Neighborhood::Neighborhood(std::shared_ptr<const Mesh> mesh,
                           std::shared_ptr<const SpatialIndex> index, std::size_t room,
                           Budget& budget)
    : mesh_(std::move(mesh)),
      index_(std::move(index)),
      candidates_(room_for(mesh_.get(), index_.get(), room)),
      hits_(candidates_.capacity()),
      budget_(&budget) {}

bool Neighborhood::gather(const Ball& ball) noexcept {
  ball_ = ball;
  hits_.clear();
  if (!ball.center.allFinite() || !(ball.radius >= 0.0) || !collect(ball)) return false;
  std::sort(candidates_.begin(), candidates_.end());  // hits are larger, and so slower to sort
  refine(*mesh_, ball, candidates_.view(), hits_);
  return true;
}

bool Neighborhood::collect(const Ball& ball) noexcept {
  candidates_.clear();
  if (budget_->is_spent()) return false;
  index_->collect(ball, candidates_);
  budget_->spend(candidates_.size() * work::hit);
  if (candidates_.overflowed() && !budget_->is_spent()) budget_->mark_overflow();
  return !candidates_.overflowed() && !budget_->is_spent();
}

namespace {

/// Returns the candidate within the ball that is nearest to its center.
std::optional<Hit> nearest_of(const Mesh& mesh, const Ball& ball,
                              std::span<const TriangleId> candidates) noexcept {
  std::optional<Hit> best;
  for (const TriangleId t : candidates) {
    const ClosestPoint closest = closest_point(mesh.triangle(t), ball.center);
    if (closest.distance > ball.radius) continue;
    const bool nearer = !best || closest.distance < best->closest.distance ||
                        (closest.distance == best->closest.distance && t < best->triangle);
    if (nearer) best = {t, closest};
  }
  return best;
}

/// Finds the nearest triangle by queries with a ball. The ball grows until it touches the mesh, and
/// shrinks if it touches more triangles than the capacity. If no ball fits, marks an overflow of
/// the budget.
std::optional<Hit> find_nearest_by_queries(const Mesh& mesh, const SpatialIndex& index,
                                           const Vec3& point, double guess,
                                           TriangleBuffer& candidates, Budget& budget) noexcept {
  const Box& bounds = mesh.bounds();
  const double size = bounds.size().norm() + point.cwiseAbs().maxCoeff() + bounds.low.norm();
  // No triangle is nearer than the bounds. The second term prevents a start at 0.
  double radius = std::max(distance_to(bounds, point) * (1.0 + 1e-12) + 1e-6 * size, guess);
  double empty = 0.0;  // largest radius of a ball without triangles [length]
  double crowded = std::numeric_limits<double>::infinity();  // ... and least radius with too many
                                                             // [length]
  // Doubling ends within some tens of rounds. So does halving, at neighboring numbers.
  constexpr int most_rounds = 80;
  for (int round = 0; round < most_rounds && !budget.is_spent(); ++round) {
    candidates.clear();
    index.collect({point, radius}, candidates);
    budget.spend(work::nearest_box);
    budget.spend(candidates.size() * work::hit);
    if (candidates.overflowed()) {
      crowded = radius;
    } else if (const auto best = nearest_of(mesh, {point, radius}, candidates.view())) {
      return best;
    } else {
      empty = radius;
    }
    const double next = 2.0 * radius < crowded ? 2.0 * radius : empty + 0.5 * (crowded - empty);
    if (!(next > empty && next < crowded)) {
      budget.mark_overflow();
      return std::nullopt;
    }
    radius = next;
  }
  return std::nullopt;
}

std::optional<Hit> find_nearest(const Mesh& mesh, const SpatialIndex& index, const Vec3& point,
                                double guess, TriangleBuffer& candidates, Budget& budget) noexcept {
  if (const TriangleId found = index.nearest(point, budget); found != no_triangle) {
    return Hit{found, closest_point(mesh.triangle(found), point)};
  }
  // The index has no search of its own, or its search has spent the budget, which ends these
  // queries.
  return find_nearest_by_queries(mesh, index, point, guess, candidates, budget);
}

}  // namespace

std::optional<Hit> find_nearest(Neighborhood& neighborhood, const Vec3& point) noexcept {
  return find_nearest(neighborhood.mesh(), neighborhood.index(), point, 0.0,
                      neighborhood.candidates(), neighborhood.budget());
}

NearestTriangle::NearestTriangle(const Mesh& mesh, const SpatialIndex& index)
    : mesh_(&mesh), index_(&index), candidates_(4096) {}

Hit NearestTriangle::operator()(const Vec3& point, double guess) {
  Budget unlimited;
  while (true) {
    if (const auto hit = find_nearest(*mesh_, *index_, point, guess, candidates_, unlimited)) {
      return *hit;
    }
    candidates_ = TriangleBuffer(2 * candidates_.capacity());
  }
}

}  // namespace keepout
