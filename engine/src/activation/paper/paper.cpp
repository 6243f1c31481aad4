// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/paper.h"

#include <array>
#include <span>
#include <utility>

#include "keepout/activation/planes.h"
#include "paper_blocks.h"

namespace keepout {
namespace {

/// The edges on which a feature lies: one for an edge, the two that meet for a vertex.
struct EdgesAt {
  std::array<int, 2> edges;
  int count;

  explicit EdgesAt(Feature f) noexcept
      : edges{number_of(f), (number_of(f) + 2) % 3}, count(is_vertex(f) ? 2 : 1) {}

  const int* begin() const noexcept { return edges.data(); }
  const int* end() const noexcept { return edges.data() + count; }
};

}  // namespace

PaperRule::PaperRule() = default;
PaperRule::~PaperRule() = default;

void PaperRule::prepare(Neighborhood& neighborhood) {
  ActivationRule::prepare(neighborhood);
  adjacency_ = std::make_unique<const Adjacency>(mesh());
  blocks_ = nullptr;
  if (const TriangleBlocks* const blocks = neighborhood.index().blocks()) {
    blocks_ =
        std::make_unique<PaperBlocks>(*this, mesh(), *adjacency_, *blocks, neighborhood.room());
  }
}

bool PaperRule::gather(const RuleInput& input) noexcept {
  return blocks_ != nullptr || ActivationRule::gather(input);
}

std::size_t PaperRule::triangles() const noexcept {
  return blocks_ ? blocks_->triangles() : ActivationRule::triangles();
}

Opening PaperRule::open(const RuleInput& input, HalfSpaceBuffer& planes) noexcept {
  if (blocks_) return {blocks_->find(input, planes) ? Status::free : Status::over_capacity};
  for (const Hit& hit : hits()) {
    if (const std::optional<HalfSpace> plane = plane_of(input, hit)) planes.push(*plane);
  }
  return {};
}

Judgement PaperRule::judge(const RuleInput& input, const Vec3& trial,
                           HalfSpaceBuffer& planes) noexcept {
  if (blocks_ && !blocks_->covers(input, trial)) return {Judgement::Verdict::blocked, 0.0};
  return ActivationRule::judge(input, trial, planes);
}

std::optional<HalfSpace> PaperRule::plane_of(const RuleInput& input,
                                             const Hit& hit) const noexcept {
  const Vec3 normal = mesh().normal(hit.triangle);
  const bool positive = on_positive_side(input, hit, normal);

  // Condition 1: the closest point is in the triangle.
  if (is_face(hit.closest.feature)) {
    if (!positive) return std::nullopt;
    return plane_through(hit, normal, input.clearance);
  }
  // Condition 2: the closest point is on a ridge, and nearest for the neighbor as well.
  switch (role_in_condition_2(input, hit)) {
    case Role::speaks: {
      if (!touches(input, hit)) return plane_through(hit, away_from(hit), input.clearance);
      if (normal.isZero(0.0)) return std::nullopt;
      return plane_through(hit, normal, input.clearance);
    }
    case Role::leaves_it_to_a_neighbor:
      return std::nullopt;
    case Role::none:
      break;
  }
  // Condition 3: the closest point is on a valley.
  if (positive && !normal.isZero(0.0) && touches_a_valley(hit)) {
    return plane_through(hit, normal, input.clearance);
  }
  return std::nullopt;
}

PaperRule::Role PaperRule::role_in_condition_2(const RuleInput& input,
                                               const Hit& hit) const noexcept {
  Role role = Role::none;
  for (const int edge : EdgesAt(hit.closest.feature)) {
    const EdgeKind kind = adjacency_->kind(hit.triangle, edge);
    if (kind != EdgeKind::convex && kind != EdgeKind::coplanar) continue;
    const TriangleId neighbor = adjacency_->neighbor(hit.triangle, edge);
    const ClosestPoint theirs = closest_point(mesh().triangle(neighbor), input.tip);
    if (is_face(theirs.feature) || theirs.offset != hit.closest.offset) continue;
    // On the surface each face has its own plane, because there is no shared one.
    if (neighbor < hit.triangle && !touches(input, hit)) return Role::leaves_it_to_a_neighbor;
    role = Role::speaks;
  }
  return role;
}

bool PaperRule::touches_a_valley(const Hit& hit) const noexcept {
  for (const int edge : EdgesAt(hit.closest.feature)) {
    if (adjacency_->kind(hit.triangle, edge) == EdgeKind::concave) return true;
  }
  return false;
}

}  // namespace keepout
