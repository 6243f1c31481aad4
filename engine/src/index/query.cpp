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
  std::sort(hits.begin(), hits.end(),
            [](const Hit& a, const Hit& b) { return a.triangle < b.triangle; });
}

namespace {

std::size_t room_for(const Mesh* mesh, const SpatialIndex* index, std::size_t asked) {
  if (mesh == nullptr || index == nullptr) {
    throw Error("a query needs a mesh and an index: one of them was not given");
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

bool Neighborhood::look(const Ball& ball) noexcept {
  ball_ = ball;
  candidates_.clear();
  hits_.clear();
  if (!ball.center.allFinite() || !(ball.radius >= 0.0)) return false;
  index_->collect(ball, candidates_);
  budget_->spend(work_of_hit * candidates_.size());
  if (candidates_.overflowed()) budget_->mark_overflow();
  if (candidates_.overflowed() || budget_->is_spent()) return false;
  refine(*mesh_, ball, candidates_.view(), hits_);
  return true;
}

namespace {

/// Of the candidates within the ball, the one nearest to its centre.
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

std::optional<Hit> find_nearest(const Mesh& mesh, const SpatialIndex& index, const Vec3& point,
                                double guess, TriangleBuffer& candidates, Budget& budget) noexcept {
  if (const TriangleId its = index.nearest(point, budget); its != no_triangle) {
    return Hit{its, closest_point(mesh.triangle(its), point)};
  }
  const Box& bounds = mesh.bounds();
  const double size = bounds.size().norm() + point.cwiseAbs().maxCoeff() + bounds.low.norm();
  // No triangle is nearer than the box around them; the floor keeps the growth from starting at 0.
  double radius = std::max(distance_to(bounds, point) * (1.0 + 1e-12) + 1e-6 * size, guess);
  double empty = 0.0;  // nothing is within
  double crowded = std::numeric_limits<double>::infinity();
  // Doubling ends within some tens of rounds, and so does halving, at neighbouring numbers.
  constexpr int most_rounds = 80;
  for (int round = 0; round < most_rounds && !budget.is_spent(); ++round) {
    candidates.clear();
    index.collect({point, radius}, candidates);
    budget.spend(1 + work_of_hit * candidates.size());
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

}  // namespace

std::optional<Hit> find_nearest(Neighborhood& near, const Vec3& point) noexcept {
  return find_nearest(near.mesh(), near.index(), point, 0.0, near.candidates(), near.budget());
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
