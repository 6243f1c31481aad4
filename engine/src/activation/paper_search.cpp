// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paper_search.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <span>

#include "../geometry/closest_on_segment.h"
#include "keepout/activation/planes.h"

namespace keepout {
namespace {

// In the `what` of a Numbered, which otherwise is a PaperAnswers::origin: the plane is the one at
// this place among those that the plain rule answered with.
constexpr std::uint32_t answered = 1u << 31;

template <class Visit>
void for_each_bit(std::uint32_t bits, Visit&& visit) noexcept {
  for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(std::countr_zero(bits)));
}

}  // namespace

PaperSearch::PaperSearch(const PaperRule& rule, const WideBvh& tree)
    : rule_(rule),
      tree_(tree),
      generation_(tree.generation()),
      edges_(edges_of_leaves(tree, rule.adjacency())),
      leaves_(tree.leaves().size()),
      rest_(std::make_unique<PaperRest>()),
      answers_(std::make_unique<PaperAnswers>()) {
  normals_.reserve(tree.mesh().triangle_count());
  for (TriangleId t = 0; t < tree.mesh().triangle_count(); ++t) {
    normals_.push_back(tree.mesh().normal(t));
  }
}

void PaperSearch::reserve(std::size_t triangles) {
  capacity_ = triangles;
  found_.resize(triangles);
  sorted_.resize(triangles);
  answered_.resize(triangles);
}

Opening PaperSearch::start(const Surroundings& around, HalfSpaceBuffer& planes) noexcept {
  if (tree_.generation() != generation_) return {Opening::Stance::over_capacity};
  const std::size_t before = planes.size();
  handed_over_ = around.needed;
  bool fits = find(around, handed_over_, planes);
  if (fits && handed_over_ == NeededPlanes::in_the_way) {
    const auto asks_for_motion = [](const HalfSpace& plane) { return plane.offset > 0.0; };
    const bool may_overflow = before + triangles_ > planes.capacity();
    if (may_overflow || std::any_of(planes.begin() + before, planes.end(), asks_for_motion)) {
      handed_over_ = NeededPlanes::all;
      planes.truncate(before);
      fits = find(around, handed_over_, planes);
    }
  }
  return {fits ? Opening::Stance::clear : Opening::Stance::over_capacity};
}

/// What idle planes were left out for holds only where they are idle.
Judgement PaperSearch::judge(const Surroundings& around, const Vec3& trial,
                             HalfSpaceBuffer& planes) noexcept {
  const Ball idle = idle_ball(around.aim);
  const bool is_told = handed_over_ == NeededPlanes::all ||
                       (trial - idle.center).norm() <= idle.radius + 0.5 * around.rounding;
  if (!is_told) return {Judgement::Verdict::blocked, 0.0};
  return Activation::judge(around, trial, planes);
}

/// False if there are more triangles than room was made for.
bool PaperSearch::find(const Surroundings& around, NeededPlanes needed,
                       HalfSpaceBuffer& planes) noexcept {
  const PaperQuery query = paper_query(around, tree_.coordinate_error(), needed);
  walk(query);
  triangles_ = found_count_ = answered_count_ = 0;
  std::span<const std::uint32_t> leaves(leaves_.data(), leaf_count_);
  while (!leaves.empty() && triangles_ <= capacity_) {
    leaves = leaves.subspan(look(tree_, edges_, query, leaves, *rest_));
    screen(edges_, query, *rest_, *answers_);
    take_in(*answers_, around);
  }
  if (triangles_ > capacity_) {
    triangles_ = 0;
    return false;
  }
  const std::span<const Numbered> found =
      sort_by_number({found_.data(), found_count_}, {sorted_.data(), found_count_});
  for (const Numbered& triangle : found) planes.push(plane_of(triangle, around));
  return true;
}

void PaperSearch::walk(const PaperQuery& query) noexcept {
  std::array<std::uint32_t, 8 * NodeBlock::lanes> stack;
  std::size_t waiting = 0;
  stack[waiting++] = 0;
  leaf_count_ = 0;
  while (waiting > 0) {
    const NodeBlock& node = tree_.nodes()[stack[--waiting]];
    for_each_bit(boxes_near(node, query), [&](std::size_t lane) {
      const std::uint32_t child = node.child[lane];
      if ((child & NodeBlock::leaf) != 0) {
        leaves_[leaf_count_++] = child & ~NodeBlock::leaf;
      } else {
        stack[waiting++] = child;
      }
    });
  }
}

void PaperSearch::take_in(const PaperAnswers& answers, const Surroundings& around) noexcept {
  triangles_ += answers.in;
  if (triangles_ > capacity_) return;
  for (std::size_t i = 0; i < answers.planes; ++i) {
    found_[found_count_++] = {answers.triangle[i], answers.origin[i]};
  }
  for (std::size_t i = 0; i < answers.opens; ++i) ask_rule(answers.open[i], around);
}

void PaperSearch::ask_rule(TriangleId t, const Surroundings& around) noexcept {
  const ClosestPoint closest = closest_point(tree_.mesh().triangle(t), around.ball.center);
  if (!(closest.distance <= around.ball.radius)) return;
  if (triangles_ >= capacity_) {
    triangles_ = capacity_ + 1;
    return;
  }
  ++triangles_;
  if (const std::optional<HalfSpace> plane = rule_.plane_of(around, {t, closest})) {
    found_[found_count_++] = {t, answered | static_cast<std::uint32_t>(answered_count_)};
    answered_[answered_count_++] = *plane;
  }
}

HalfSpace PaperSearch::plane_of(const Numbered& found, const Surroundings& around) const noexcept {
  const auto [t, what] = found;
  if ((what & answered) != 0) return answered_[what & ~answered];
  const Mesh& mesh = tree_.mesh();
  const Corners& corners = mesh.corners(t);
  const auto from_tip = [&](std::uint32_t corner) -> Vec3 {
    return mesh.vertex(corners[corner]) - around.tip;
  };
  const std::uint32_t one = what & 3u;
  const std::uint32_t other = (what >> 2) & 3u;
  Hit hit{t, {from_tip(one), 0.0, Feature::face}};
  if (one != other) {
    hit.closest.offset = closest_on_segment(hit.closest.offset, from_tip(other)).point;
  }
  if ((what & PaperAnswers::faces_tip) == 0) return plane_through(hit, normals_[t], around.margin);
  hit.closest.distance = std::sqrt(hit.closest.offset.squaredNorm());
  return plane_through(hit, away_from(hit), around.margin);
}

}  // namespace keepout
