// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/index/query.h"
#include "keepout/judges/tip_judge.h"
#include "keepout/mesh/mesh.h"

namespace keepout::app {

/// A mesh of a campaign, with the structures that are built once: the index that the guard
/// searches, and the oracle that judges.
class Scene {
 public:
  /// Throws Error if there is no index of this name.
  Scene(std::string name, Surface surface, std::string_view index);
  Scene(std::string name, std::shared_ptr<const Mesh> mesh, std::string_view index);

  const std::string& name() const noexcept { return name_; }
  const std::shared_ptr<const Mesh>& mesh() const noexcept { return mesh_; }
  const SpatialIndex& index() const noexcept { return *index_; }
  const std::shared_ptr<const SpatialIndex>& shared_index() const noexcept { return index_; }
  const oracle::JudgedSurface& judged() const noexcept { return judged_; }
  const oracle::SafetyOracle& oracle() const noexcept { return judged_.oracle(); }
  const std::shared_ptr<const monitor::TriangleTree>& tree() const noexcept {
    return oracle().tree();
  }

  double mean_edge() const noexcept { return mean_edge_; }  // [length], > 0
  double farthest() const noexcept { return farthest_; }    // largest 1-norm of a vertex [length]

  /// Returns true if the engine knows a free side: each edge has two triangles with consistent
  /// winding.
  bool has_sides() const noexcept { return has_sides_; }

  /// Returns the nearest triangle by the engine's own search, to find hostile places. Not for
  /// judging.
  Hit nearest(const Vec3& point, double guess = 0.0) { return nearest_(point, guess); }

 private:
  std::string name_;
  std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<const SpatialIndex> index_;
  oracle::JudgedSurface judged_;
  NearestTriangle nearest_;
  double mean_edge_ = 0.0;
  double farthest_ = 0.0;
  bool has_sides_;
};

/// Throws Error with the name of the mesh if none of its triangles has an area.
void require_area(const std::string& name, const Mesh& mesh);

/// A mesh that a campaign may load. It is one mesh, maybe in several places, with a scene for each
/// place; or a kind of mesh, drawn anew for each start of an instrument.
struct Arena {
  std::string mesh;
  std::function<std::vector<Scene>()> load = {};             // none once a signal has come
  std::function<std::shared_ptr<Scene>(Random&)> draw = {};  // instead
};

/// Returns each generated shape, at the origin and 1e4 mm away.
std::vector<Arena> generated_arenas(const std::string& index);

/// Returns the real meshes in the cache. Appends an error text for each of the others to `missing`.
std::vector<Arena> real_arenas(const std::string& index, std::vector<std::string>& missing);

/// Returns a mesh that the user names (named_mesh.h). It is read when the campaign reaches it.
Arena named_arena(const std::string& mesh, const std::string& index);

/// Returns kinds of meshes of at most 400 triangles, about 40 mm large. The kinds are `soup`
/// (crossing triangles), `fan` (ridges and valleys around one vertex), `sheets` (1e-9 mm apart),
/// `cone`, `bowl` and `saddle`.
std::vector<Arena> hostile_arenas(const std::string& index);

}  // namespace keepout::app
