// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "keepout/buffer.h"
#include "keepout/geometry/shapes.h"
#include "keepout/ids.h"
#include "keepout/index/budget.h"
#include "keepout/index/motion_traversal.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

class TriangleBlocks;

/// A list of triangle numbers with a fixed capacity.
using TriangleBuffer = Buffer<TriangleId>;

/// Finds the triangles near a point. An index proposes candidates, and the exact kernel decides
/// (refine), so every index gives the same hits.
///
/// Objects that use an index refer to it, so it can be neither copied nor assigned to.
class SpatialIndex {
 public:
  SpatialIndex(const SpatialIndex&) = delete;
  SpatialIndex& operator=(const SpatialIndex&) = delete;
  virtual ~SpatialIndex() = default;

  /// Returns the mesh that the index was built on, or last refit to.
  const Mesh& mesh() const noexcept { return *mesh_; }
  /// Returns the mesh as a shared pointer.
  const std::shared_ptr<const Mesh>& shared_mesh() const noexcept { return mesh_; }

  /// Appends, once each and in any order, every triangle that touches the ball. May append others,
  /// but must not miss any, unless the capacity is exceeded: then it may stop. Thread-safe.
  virtual void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept = 0;

  /// Like collect, for a capsule: by default with several balls along it.
  virtual void collect_near(const Capsule& capsule, TriangleBuffer& candidates) const noexcept;

  /// Returns true if the candidates are exactly the triangles that touch the ball by the exact
  /// kernel.
  virtual bool is_exact() const noexcept { return false; }

  /// Returns the triangle nearest to a point by the exact kernel, at any distance. If several
  /// triangles are equally near, returns the lowest number. Returns no_triangle if the index has no
  /// such search (see find_nearest), or once the budget is spent. Thread-safe. Precondition: the
  /// point is finite.
  virtual TriangleId nearest(const Vec3& /*point*/, Budget& /*budget*/) const noexcept {
    return no_triangle;
  }

  /// Returns the index's own traversal along motions; null if the index has no such traversal (see
  /// make_motion_traversal). A traversal shows far fewer triangles than a query. The traversal
  /// spends work units of the budget. Index and budget must outlive it, and the index must not be
  /// refit.
  virtual std::unique_ptr<MotionTraversal> traverse_along_motions(Budget& /*budget*/) const {
    return nullptr;
  }

  /// Returns true if traverse_along_motions() returns a traversal. Override both.
  virtual bool traverses() const noexcept { return false; }

  /// Returns an index of a mesh with the same triangles and moved vertices, in a fraction of the
  /// time of a build. Returns null if the index does not support this. Other threads may use this
  /// index during the call. Throws Error if the corners of a triangle differ.
  virtual std::unique_ptr<SpatialIndex> refitted(std::shared_ptr<const Mesh> /*moved*/) const {
    return nullptr;
  }

  /// Returns the triangles in blocks of keepout's own format; null if the index has none. Valid as
  /// long as the index lives.
  virtual const TriangleBlocks* blocks() const noexcept { return nullptr; }

  /// Returns the largest difference of the index's coordinates from the mesh's; 0 if it uses the
  /// mesh's. [length]
  virtual double rounding() const noexcept { return 0.0; }

  /// Returns the memory of the index, without the mesh. [bytes]
  virtual std::size_t memory() const noexcept = 0;

 protected:
  /// Stores the mesh. Throws Error if it is null.
  explicit SpatialIndex(std::shared_ptr<const Mesh> mesh);

  /// Replaces the mesh, after a refit.
  void set_mesh(std::shared_ptr<const Mesh> moved) noexcept { mesh_ = std::move(moved); }

 private:
  std::shared_ptr<const Mesh> mesh_;
};

/// The work of a query. Unlike its time, the work is the same on every run. More work for the same
/// query shows a worse tree.
struct QueryCounts {
  std::size_t nodes = 0;      // examined nodes, each with all its boxes
  std::size_t blocks = 0;     // leaf blocks whose triangles were compared with the ball
  std::size_t triangles = 0;  // undecided in single precision: the exact kernel decided
};

}  // namespace keepout
