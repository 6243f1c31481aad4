// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/brute_force.h"
#include "keepout/index/wide_bvh.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/wide_bvh_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "wide_bvh_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

void walk_wide_bvh(const NodeBlock* nodes, const LeafBlock* leaves, const Mesh& mesh,
                   const BallScreen& ball, TriangleBuffer& out) {
  walk(nodes, ball, TouchingTriangles<false>{leaves, mesh, ball, out, nullptr});
}

void walk_wide_bvh_counting(const NodeBlock* nodes, const LeafBlock* leaves, const Mesh& mesh,
                            const BallScreen& ball, TriangleBuffer& out, QueryCounts& counts) {
  walk(nodes, ball, TouchingTriangles<true>{leaves, mesh, ball, out, &counts});
}

void walk_to_leaves(const NodeBlock* nodes, const BallScreen& ball, LeafBuffer& found) {
  walk(nodes, ball, TouchedLeaves{found});
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(walk_wide_bvh);
HWY_EXPORT(walk_wide_bvh_counting);
HWY_EXPORT(walk_to_leaves);

void WideBvh::collect(const Ball& ball, TriangleBuffer& candidates) const noexcept {
  const BallScreen screen(ball, mesh_->bounds(), coordinate_error_);
  if (!screen.fits) return BruteForce(mesh_).collect(ball, candidates);
  HWY_DYNAMIC_DISPATCH(walk_wide_bvh)(nodes_.data(), leaves_.data(), *mesh_, screen, candidates);
}

void WideBvh::collect(const Ball& ball, TriangleBuffer& candidates,
                      QueryCounts& counts) const noexcept {
  const BallScreen screen(ball, mesh_->bounds(), coordinate_error_);
  if (!screen.fits) {
    counts.triangles += mesh_->triangle_count();
    return BruteForce(mesh_).collect(ball, candidates);
  }
  HWY_DYNAMIC_DISPATCH(walk_wide_bvh_counting)
  (nodes_.data(), leaves_.data(), *mesh_, screen, candidates, counts);
}

void WideBvh::collect_leaves(const Ball& ball, LeafBuffer& found) const noexcept {
  const BallScreen screen(ball, mesh_->bounds(), coordinate_error_);
  if (!screen.fits) return collect_all_leaves(found);
  HWY_DYNAMIC_DISPATCH(walk_to_leaves)(nodes_.data(), screen, found);
}

}  // namespace keepout

#endif  // HWY_ONCE
