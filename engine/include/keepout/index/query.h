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

/// A list of hits with a fixed capacity.
using HitBuffer = Buffer<Hit>;

/// Fills `hits` with the candidates that touch the ball. The exact kernel decides this: distance <=
/// radius. Hits are sorted by id, so that results do not depend on the order of a traversal.
void refine(const Mesh& mesh, const Ball& ball, std::span<const TriangleId> candidates,
            HitBuffer& hits) noexcept;

/// A mesh with its index and a work budget. With any index, it finds exactly the triangles that
/// touch a ball. The index proposes candidates, and refine() selects the hits. All memory is
/// allocated at construction. Make one for each thread; mesh and index may be shared. If a rule
/// uses the index's own traversal, this object only holds mesh, index and the budget of the cycle.
class Neighborhood {
 public:
  /// Allocates a capacity of `room` candidates in a query, or of all triangles if they are fewer.
  /// Queries spend work units of `budget`, which must outlive this object. Throws Error without a
  /// mesh or an index, or if the index is for another mesh.
  Neighborhood(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index,
               std::size_t room, Budget& budget);

  /// Finds all triangles that touch the ball. Returns false, without hits, if the candidates exceed
  /// the capacity or the budget, if the center is not finite, or if the radius is negative or NaN.
  [[nodiscard]] bool gather(const Ball& ball) noexcept;

  /// Fills candidates() with the triangles that may touch a ball; hits() and ball() do not change.
  /// Returns false if they exceed the capacity, or if the budget is spent.
  [[nodiscard]] bool collect(const Ball& ball) noexcept;

  /// Returns the hits of the last gather, sorted by number; closest points are relative to the
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
  /// Returns true if the index is for this mesh; false after a refit to another mesh.
  bool is_current() const noexcept { return &index_->mesh() == mesh_.get(); }

  /// Returns the mesh.
  const Mesh& mesh() const noexcept { return *mesh_; }
  const std::shared_ptr<const Mesh>& shared_mesh() const noexcept { return mesh_; }
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

/// Returns the triangle nearest to a point, and its closest point, relative to `point`. If several
/// triangles are equally near, returns the one with the lowest id. Bitwise identical on every
/// index. An index without its own search (SpatialIndex::nearest) is queried with a ball around the
/// point that grows until it touches the mesh. Far from the mesh, this ball may touch many
/// triangles. Returns empty if these triangles exceed the capacity, or if the budget is spent. The
/// neighborhood's hits do not change. Does not allocate. Precondition: the point is finite.
std::optional<Hit> find_nearest(Neighborhood& neighborhood, const Vec3& point) noexcept;

/// Classifies a point as inside or outside a watertight mesh that does not intersect itself. The
/// result does not depend on the order of triangles and corners. Returns empty if the triangles
/// that are about equally near exceed the capacity, or if the budget is spent. Does not allocate.
/// Precondition: the mesh is watertight.
std::optional<SideOfSurface> find_side(Neighborhood& neighborhood, const Vec3& point) noexcept;

/// Finds the nearest triangle like find_nearest, with memory that grows as needed. For
/// measurements, not for the control path.
class NearestTriangle {
 public:
  /// Makes a search of a mesh by an index; both must outlive this object.
  NearestTriangle(const Mesh& mesh, const SpatialIndex& index);

  /// Returns the triangle that find_nearest returns, with the same precondition. `guess`: the first
  /// radius of the search on an index without its own search. A good guess is the last distance
  /// plus the displacement since then. [length] Allocates.
  Hit operator()(const Vec3& point, double guess = 0.0);

 private:
  const Mesh* mesh_;
  const SpatialIndex* index_;
  TriangleBuffer candidates_;
};

}  // namespace keepout
