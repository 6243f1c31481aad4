// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "keepout/geometry/ball.h"
#include "keepout/index/refine.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// The triangles around a place, exactly, from whatever index: asks it for candidates and refines
/// them. All memory is made at construction. One for each thread; mesh and index are shared.
class Neighborhood {
 public:
  /// With room for so many candidates in a query, or all triangles if they are fewer. Throws Error
  /// without a mesh or an index.
  Neighborhood(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index,
               std::size_t room);

  /// Finds all triangles that touch the ball. False, and no hits, if the index proposes more than
  /// there is room for, or the ball is none.
  [[nodiscard]] bool look(const Ball& ball) noexcept;

  /// What the last look found, sorted by number; closest points are relative to the ball's centre.
  std::span<const Hit> hits() const noexcept { return hits_.view(); }
  /// Where it looked.
  const Ball& ball() const noexcept { return ball_; }

  /// For queries of another kind, which leave hits and ball as they are.
  TriangleBuffer& candidates() noexcept { return candidates_; }
  /// How many candidates there is room for.
  std::size_t room() const noexcept { return candidates_.capacity(); }
  /// What is looked at.
  const Mesh& mesh() const noexcept { return *mesh_; }
  /// What is asked.
  const SpatialIndex& index() const noexcept { return *index_; }

 private:
  std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<const SpatialIndex> index_;
  Ball ball_{Vec3::Zero(), -1.0};
  TriangleBuffer candidates_;
  HitBuffer hits_;
};

}  // namespace keepout
