// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "judge.h"
#include "keepout/fixtures/random.h"
#include "keepout/index/spatial_index.h"

namespace keepout::peers {

/// A mesh with its index and its judge, and the places at which rules may fail.
class Terrain {
 public:
  /// The kind of a vertex. A rim has a convex edge of more than 60 degrees. A saddle has a convex
  /// and a concave edge of more than 5 degrees each.
  enum class Kind { plain, rim, saddle };

  explicit Terrain(const std::shared_ptr<const Mesh>& mesh);

  const std::shared_ptr<const SpatialIndex>& index() const noexcept { return index_; }
  const Mesh& mesh() const noexcept { return index_->mesh(); }
  Kind kind(VertexId vertex) const noexcept { return kinds_[vertex]; }

  /// Returns a judge of the mesh, for one thread.
  Judge judge() const { return judge_; }

  /// Returns a place on the free side, at most `height` above a random triangle with a vertex of a
  /// kind, and near that vertex. If there is no such vertex, any triangle counts. Throws Error if
  /// it finds no place with that clearance, as between sheets that are too close. [mm]
  Vec3 place(Kind kind, double clearance, double height, Random& random) const;

 private:
  std::shared_ptr<const SpatialIndex> index_;
  Judge judge_;
  bool is_inside_out_;
  std::vector<Kind> kinds_;
  std::vector<TriangleId> all_, at_rims_, at_saddles_;
};

}  // namespace keepout::peers
