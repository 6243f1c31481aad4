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

/// Numbers of triangles, with a declared capacity.
using TriangleBuffer = Buffer<TriangleId>;

/// Finds the triangles near a place. An index proposes candidates; the engine's exact kernel
/// decides (refine), so every index gives the same hits.
///
/// What is built on it holds on to it: it is neither copied nor assigned to.
class SpatialIndex {
 public:
  SpatialIndex(const SpatialIndex&) = delete;
  SpatialIndex& operator=(const SpatialIndex&) = delete;
  virtual ~SpatialIndex() = default;

  /// What its triangles are of: what it was built on, or last refit to.
  const Mesh& mesh() const noexcept { return *mesh_; }
  /// The same, to hold on to.
  const std::shared_ptr<const Mesh>& shared_mesh() const noexcept { return mesh_; }

  /// Appends, once each and in any order, every triangle that touches the ball. Extra triangles are
  /// allowed, missing ones never, unless there is no room for them all: then it may stop.
  /// Thread-safe.
  virtual void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept = 0;

  /// The same for a capsule, by default by a row of balls along it.
  virtual void collect_near(const Capsule& capsule, TriangleBuffer& candidates) const noexcept;

  /// Whether the candidates are exactly the triangles that touch the ball by the engine's kernel,
  /// none extra.
  virtual bool is_exact() const noexcept { return false; }

  /// The triangle nearest to a point by the engine's kernel, of equals the lowest number, whatever
  /// the distance. no_triangle of an index that has no search of its own for it (see find_nearest),
  /// and once the budget is spent. Thread-safe. Precondition: the point is finite.
  virtual TriangleId nearest(const Vec3& /*point*/, Budget& /*budget*/) const noexcept {
    return no_triangle;
  }

  /// Returns a traversal of its own along motions, which shows far fewer triangles than are near;
  /// null if the index has none: see make_motion_traversal. Its work is taken from the budget.
  /// Index and budget must outlive it, and the index must not be refit.
  virtual std::unique_ptr<MotionTraversal> traverse_along_motions(Budget& /*budget*/) const {
    return nullptr;
  }

  /// Returns true if traverse_along_motions() returns a traversal: override both.
  virtual bool traverses() const noexcept { return false; }

  /// An index of a mesh whose triangles are the same, of as many vertices that are elsewhere, made
  /// from this one in a fraction of the time of a build, while this one is asked; null of an index
  /// that has no faster way than a build. Throws Error if the corners of a triangle differ.
  virtual std::unique_ptr<SpatialIndex> refitted(std::shared_ptr<const Mesh> /*moved*/) const {
    return nullptr;
  }

  /// Its triangles in blocks of our own format; null if the index has none. They live as long as
  /// the index.
  virtual const TriangleBlocks* blocks() const noexcept { return nullptr; }

  /// How far its coordinates may be from the mesh's; 0 if it has the mesh's own. [length]
  virtual double rounding() const noexcept { return 0.0; }

  /// Memory that the index holds beside the mesh. [bytes]
  virtual std::size_t memory() const noexcept = 0;

 protected:
  /// Of a mesh. Throws Error without one.
  explicit SpatialIndex(std::shared_ptr<const Mesh> mesh);

  /// It has become the index of another mesh.
  void set_mesh(std::shared_ptr<const Mesh> moved) noexcept { mesh_ = std::move(moved); }

 private:
  std::shared_ptr<const Mesh> mesh_;
};

/// What a query of ours had to look at. Unlike its time it is the same on every run, so that a
/// tree that got worse shows.
struct QueryCounts {
  std::size_t nodes = 0;      // looked at, each with all its boxes
  std::size_t blocks = 0;     // leaf blocks whose triangles were compared with the ball
  std::size_t triangles = 0;  // of which floats were not sure: the exact kernel was asked
};

}  // namespace keepout
