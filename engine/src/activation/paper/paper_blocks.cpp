// SPDX-License-Identifier: BSD-3-Clause
#include "paper_blocks.h"

#include <algorithm>
#include <optional>
#include <span>

#include "../../geometry/closest_on_segment.h"
#include "keepout/activation/planes.h"

namespace keepout {

PaperBlocks::PaperBlocks(const PaperRule& rule, const Mesh& mesh, const Adjacency& adjacency,
                         const TriangleBlocks& blocks, std::size_t room)
    : rule_(rule),
      mesh_(mesh),
      blocks_(blocks),
      leaves_(blocks.leaves().size()),
      unfinished_(std::make_unique<Unfinished>()),
      found_(room) {
  normals_.reserve(mesh.triangle_count());
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) normals_.push_back(mesh.normal(t));
  edges_.reserve(blocks.leaves().size());
  for (const LeafBlock& leaf : blocks.leaves()) {
    edges_.push_back(edges_of(leaf, blocks.frame(), mesh, adjacency));
  }
}

bool PaperBlocks::find(const RuleInput& input, HalfSpaceBuffer& planes) noexcept {
  triangles_ = 0;
  leaves_.clear();
  const Ball ball = rule_.region(input);
  blocks_.collect_leaves(ball, leaves_);
  const IdlePlanes idle = input.is_projected ? IdlePlanes::left_out : IdlePlanes::found;
  if (!gather(input, ball, idle)) return false;
  if (idle == IdlePlanes::left_out) {
    const auto asks_for_motion = [](const HalfSpace& plane) { return plane.offset > 0.0; };
    const bool may_overflow = planes.size() + triangles_ > planes.capacity();
    if (may_overflow || std::any_of(found_.begin(), found_.end(), asks_for_motion)) {
      gather(input, ball, IdlePlanes::found);
    }
  }
  std::sort(found_.begin(), found_.end(),
            [](const HalfSpace& a, const HalfSpace& b) { return a.source < b.source; });
  for (const HalfSpace& plane : found_.view()) planes.push(plane);
  return true;
}

/// Finds the planes, in no order. Returns false if the triangles exceed the capacity.
bool PaperBlocks::gather(const RuleInput& input, const Ball& ball, IdlePlanes idle) noexcept {
  const FilterQuery query = filter_query(input, ball, blocks_.frame(), idle);
  idle_planes_ = idle;
  found_.clear();
  triangles_ = 0;
  std::span<const std::uint32_t> leaves = leaves_.view();
  while (!leaves.empty()) {
    leaves = leaves.subspan(filter(blocks_.leaves(), edges_, leaves, query, *unfinished_));
    triangles_ += unfinished_->in;
    for (std::size_t i = 0; i < unfinished_->size; ++i) {
      const std::uint32_t which = unfinished_->which[i];
      const std::uint32_t plane = unfinished_->plane[i];
      const LeafBlock& leaf = blocks_.leaves()[which / LeafBlock::lanes];
      const TriangleId t = leaf.triangle(which % LeafBlock::lanes);
      if ((plane & (Unfinished::faces_tip | Unfinished::of_face)) == 0) {
        const Hit hit{t, closest_point(mesh_.triangle(t), ball.center)};
        if (!(hit.closest.distance <= ball.radius)) continue;
        ++triangles_;
        if (const std::optional<HalfSpace> its = rule_.plane_of(input, hit)) found_.push(*its);
      } else {
        const std::size_t place = plane >> Unfinished::plane_bits;
        const Hit hit{t, closest_point_at(place, leaf, which % LeafBlock::lanes, input.tip)};
        const bool faces_tip = (plane & Unfinished::faces_tip) != 0;
        found_.push(plane_through(hit, faces_tip ? away_from(hit) : normals_[t], input.clearance));
      }
    }
    if (triangles_ > found_.capacity()) {
      triangles_ = 0;
      return false;
    }
  }
  return true;
}

/// Returns the answer of the exact kernel for a triangle whose closest point is on this one of the
/// `places`. If the mesh's corners are floats, they are read from the leaf, which is in the cache.
ClosestPoint PaperBlocks::closest_point_at(std::size_t place, const LeafBlock& leaf,
                                           std::size_t lane, const Vec3& tip) const noexcept {
  const auto corner = [&](std::size_t c) -> Vec3 {
    if (!blocks_.frame().is_exact()) {
      return ordered_relative(mesh_.triangle(leaf.triangle(lane)), tip)[c];
    }
    return Vec3(leaf.corner[c][0][lane], leaf.corner[c][1][lane], leaf.corner[c][2][lane]) - tip;
  };
  const auto [a, b] = corners_at[place];
  Vec3 offset = corner(a);
  if (a != b) offset = closest_on_segment(offset, corner(b)).point;
  return {offset, offset.norm(), Feature::face};
}

bool PaperBlocks::covers(const RuleInput& input, const Vec3& motion) const noexcept {
  if (idle_planes_ == IdlePlanes::found) return true;
  const Ball idle = idle_ball(input.target);
  return (motion - idle.center).norm() <= idle.radius + 0.5 * input.rounding;
}

}  // namespace keepout
