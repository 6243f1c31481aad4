// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/index/query.h"
#include "keepout/mesh/mesh.h"
#include "keepout/oracle/safety_oracle.h"

namespace keepout::app {

/// A mesh to campaign on, and what is built on it once: the index that the guard searches, and the
/// oracle that judges it.
class Scene {
 public:
  /// Throws Error when there is no index of that name.
  Scene(std::string name, Surface surface, std::string_view index);
  Scene(std::string name, std::shared_ptr<const Mesh> mesh, std::string_view index);

  const std::string& name() const noexcept { return name_; }
  const std::shared_ptr<const Mesh>& mesh() const noexcept { return mesh_; }
  const SpatialIndex& index() const noexcept { return *index_; }
  const std::shared_ptr<const SpatialIndex>& shared_index() const noexcept { return index_; }
  const oracle::SafetyOracle& oracle() const noexcept { return oracle_; }
  const std::shared_ptr<const oracle::TriangleTree>& tree() const noexcept {
    return oracle_.tree();
  }

  double mean_edge() const noexcept { return mean_edge_; }        // [length], > 0
  double longest_edge() const noexcept { return longest_edge_; }  // [length]
  double farthest() const noexcept { return farthest_; }  // largest 1-norm of a vertex [length]

  /// The engine knows a free side here: each edge has two triangles that are wound alike.
  bool has_sides() const noexcept { return has_sides_; }

  /// Strictly on the side that the normals point away from, by the oracle. Precondition:
  /// has_sides().
  bool is_forbidden(const Vec3& point) const;

  /// The nearest triangle by the engine's own search: to find nasty places with, not to judge by.
  Hit nearest(const Vec3& point, double guess = 0.0) { return nearest_(point, guess); }

 private:
  std::string name_;
  std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<const SpatialIndex> index_;
  oracle::SafetyOracle oracle_;
  NearestTriangle nearest_;
  double mean_edge_ = 0.0;
  double longest_edge_ = 0.0;
  double farthest_ = 0.0;
  bool has_sides_;
  bool free_inside_ = false;  // the normals point into what is enclosed
};

/// A mesh that a campaign may load: the same, maybe in several places, one scene each; or a kind of
/// mesh, of which one is drawn anew for each start of an instrument.
struct Arena {
  std::string mesh;
  std::function<std::vector<Scene>()> load = {};
  std::function<std::shared_ptr<Scene>(Random&)> draw = {};  // instead
};

/// Each generated shape, where it was made and 1e4 mm away.
std::vector<Arena> generated_arenas(const std::string& index);

/// The real meshes in the cache; `missing` is told the others.
std::vector<Arena> real_arenas(const std::string& index, std::vector<std::string>& missing);

/// A mesh that the user names (named_mesh.h). It is read when it is its turn.
Arena named_arena(const std::string& mesh, const std::string& index);

/// Meshes of at most 400 triangles, some 40 mm large, that are drawn anew for each start: `soup`
/// (crossing triangles), `fan` (ridges and valleys around one vertex), `sheets` (1e-9 mm apart),
/// `cone`, `bowl` and `saddle`.
std::vector<Arena> hostile_arenas(const std::string& index);

}  // namespace keepout::app
