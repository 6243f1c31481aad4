// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "../../index/tree_parts/triangle_blocks.h"
#include "float_filter.h"
#include "keepout/activation/paper.h"
#include "leaf_edges.h"

namespace keepout {

/// The rule `paper` on an index with leaf blocks. It reads each leaf once, for the query and for
/// the conditions. Floats decide where they are sure, and PaperRule decides the other triangles. So
/// the planes and their order are identical to PaperRule's, for every index and lane width.
///
/// If the answer is a projection (RuleInput::is_projected), idle planes are not computed: as long
/// as standing still is allowed, all motions that the solver considers are in idle_ball. Otherwise
/// the solver gets all planes.
class PaperBlocks {
 public:
  /// Allocates memory for `room` triangles in a ball. All arguments must outlive this object, and
  /// belong to one mesh.
  PaperBlocks(const PaperRule& rule, const Mesh& mesh, const Adjacency& adjacency,
              const TriangleBlocks& blocks, std::size_t room);

  /// Appends the planes of the rule in its region. Returns false if the triangles exceed the
  /// capacity.
  bool find(const RuleInput& input, HalfSpaceBuffer& planes) noexcept;

  /// Returns the number of triangles in the ball of the last find().
  std::size_t triangles() const noexcept { return triangles_; }

  /// Returns true if the planes of the last find() are all that can exclude the motion. It left out
  /// planes only for motions in idle_ball.
  bool covers(const RuleInput& input, const Vec3& motion) const noexcept;

 private:
  bool gather(const RuleInput& input, const Ball& ball, IdlePlanes idle) noexcept;
  ClosestPoint closest_point_at(std::size_t place, const LeafBlock& leaf, std::size_t lane,
                                const Vec3& tip) const noexcept;

  const PaperRule& rule_;
  const Mesh& mesh_;
  const TriangleBlocks& blocks_;
  std::vector<LeafEdges> edges_;  // of each leaf
  std::vector<Vec3> normals_;     // of each triangle

  // The state of the present cycle.
  IdlePlanes idle_planes_ = IdlePlanes::found;
  std::size_t triangles_ = 0;  // in the ball
  LeafBuffer leaves_;          // leaves that the ball touches
  std::unique_ptr<Unfinished> unfinished_;
  HalfSpaceBuffer found_{0};
};

}  // namespace keepout
