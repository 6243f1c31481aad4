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

/// The paper's rule on an index whose triangles are in leaf blocks: query and conditions in one
/// look at each leaf. Floats tell which triangles have a plane where they are sure, PaperRule is
/// asked about the others. So the planes are its own, bit for bit and in the same order, whatever
/// the index and the width of lanes.
///
/// Where the answer is a projection (RuleInput::is_projected), idle planes are not even made: as
/// long as standing still is allowed, all that the solver looks at lies in idle_ball. Otherwise it
/// gets them all.
class PaperBlocks {
 public:
  /// With room for so many triangles in a ball. All must outlive this; they are of one mesh.
  PaperBlocks(const PaperRule& rule, const Mesh& mesh, const Adjacency& adjacency,
              const TriangleBlocks& blocks, std::size_t room);

  /// Appends the planes that the rule has in its region. False if there are more triangles than
  /// room was made for.
  bool find(const RuleInput& input, HalfSpaceBuffer& planes) noexcept;

  /// How many triangles were in the ball when planes were last found.
  std::size_t triangles() const noexcept { return triangles_; }

  /// Whether the planes that were last found are all that could speak against a motion: idle ones
  /// were left out only for motions that they are idle for.
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

  // Of this cycle.
  IdlePlanes idle_planes_ = IdlePlanes::found;
  std::size_t triangles_ = 0;  // in the ball
  LeafBuffer leaves_;          // that the ball touches
  std::unique_ptr<Unfinished> unfinished_;
  HalfSpaceBuffer found_{0};
};

}  // namespace keepout
