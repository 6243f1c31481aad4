// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "keepout/buffer.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/geometry/shapes.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/mesh/side_of_surface.h"

namespace keepout {

/// A triangle that touches the query ball, and its point nearest to the center.
struct Hit {
  TriangleId triangle;   // its number
  ClosestPoint closest;  // relative to the ball's center
};

/// The work of finding one, in work units (Budget): mostly cache misses.
inline constexpr std::size_t work_of_hit = 4;

/// Hits, with a declared capacity.
using HitBuffer = Buffer<Hit>;

/// Fills `hits` with the candidates that touch the ball by the exact kernel (distance <= radius),
/// sorted by id, so that nothing downstream depends on the order of a traversal.
void refine(const Mesh& mesh, const Ball& ball, std::span<const TriangleId> candidates,
            HitBuffer& hits) noexcept;

/// A mesh with its index and a work budget, and the triangles that touch a ball, exactly, on any
/// index: the index proposes candidates, and refine() keeps the hits. All memory is made at
/// construction. One for each thread; mesh and index are shared. Where the index has a search of
/// its own, as for a traversal along motions, this only carries mesh, index and the budget of the
/// cycle, which is the one that the cycle itself spends.
class Neighborhood {
 public:
  /// With a capacity of `room` candidates in a query, or of all triangles if they are fewer.
  /// Queries take their work from `budget`, which must outlive this. Throws Error without a mesh or
  /// an index, or if the index is of another mesh.
  Neighborhood(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index,
               std::size_t room, Budget& budget);

  /// Finds all triangles that touch the ball. Returns false, without hits, if the index proposes
  /// more than there is room for, or than the budget allows, or if the center is not finite or the
  /// radius negative or NaN.
  [[nodiscard]] bool gather(const Ball& ball) noexcept;

  /// Fills candidates() with the triangles that may touch a ball; hits and ball stay as they are.
  /// Returns false if there is no room for them, or if the budget is spent.
  [[nodiscard]] bool collect(const Ball& ball) noexcept;

  /// Returns what the last gather found, sorted by number; closest points are relative to the
  /// ball's center.
  std::span<const Hit> hits() const noexcept { return hits_.view(); }
  /// Returns the ball of the last gather.
  const Ball& ball() const noexcept { return ball_; }

  /// Returns the candidates of the last query.
  TriangleBuffer& candidates() noexcept { return candidates_; }
  /// Returns the capacity for candidates.
  std::size_t room() const noexcept { return candidates_.capacity(); }
  /// Returns the work budget, shared with the users of the hits. The owner of the control cycle
  /// resets it.
  Budget& budget() const noexcept { return *budget_; }
  /// Returns true if the index is still of the mesh: not so once it was refit to another.
  bool is_current() const noexcept { return &index_->mesh() == mesh_.get(); }

  /// Returns the mesh.
  const Mesh& mesh() const noexcept { return *mesh_; }
  /// Returns the index.
  const SpatialIndex& index() const noexcept { return *index_; }

 private:
  std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<const SpatialIndex> index_;
  inline static const Ball nowhere{Vec3::Zero(), -1.0};
  Ball ball_ = nowhere;
  TriangleBuffer candidates_;
  HitBuffer hits_;
  Budget* budget_;
};

/// Returns the triangle nearest to a point, and its closest point, relative to `point`; ties go to
/// the lowest id. Bitwise identical on every index. An index without a search of its own
/// (SpatialIndex::nearest) is queried with a ball around the point that grows until it touches the
/// mesh: far from the mesh that may be a large part of it. Returns nothing if that is more than
/// there is room for, or if the budget is spent. Hits stay as they are. Allocates nothing.
/// Precondition: the point is finite.
std::optional<Hit> find_nearest(Neighborhood& neighborhood, const Vec3& point) noexcept;

/// Classifies a point as inside or outside a watertight mesh that does not cut through itself. The
/// result does not depend on the order of triangles and corners. Returns nothing if more triangles
/// are about equally near than there is room for, or if the budget is spent. Allocates nothing.
/// Precondition: the mesh is watertight.
std::optional<SideOfSurface> find_side(Neighborhood& neighborhood, const Vec3& point) noexcept;

/// Like find_nearest, with memory that grows as needed: for measuring, not for the control path.
class NearestTriangle {
 public:
  /// Both must outlive this object.
  NearestTriangle(const Mesh& mesh, const SpatialIndex& index);

  /// The nearest triangle; ties and precondition as for find_nearest. `guess`: for an index without
  /// a search of its own a radius worth trying first, such as the last distance plus the
  /// displacement since. [length] Allocates.
  Hit operator()(const Vec3& point, double guess = 0.0);

 private:
  const Mesh* mesh_;
  const SpatialIndex* index_;
  TriangleBuffer candidates_;
};

}  // namespace keepout
