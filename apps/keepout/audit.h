// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "keepout/index/nearest.h"
#include "simulation_record.h"

namespace keepout::app {

/// Whether a point is inside a closed surface, by counting how often a ray along x leaves it.
///
/// Independent of everything that the fixture decides with: no tree, no closest point, no normal,
/// no winding. Triangles are filed in a grid over (y, z). Each edge is tested on its own vertices
/// in one fixed order, so the two triangles beside it agree, to the bit, on which side the ray
/// passes: no ray slips through a seam or counts it twice.
class InsideTest {
 public:
  explicit InsideTest(const Mesh& mesh);

  /// Precondition: the mesh is closed (each edge has an even number of triangles).
  bool operator()(const Vec3& point) const;

 private:
  std::size_t column(int axis, double coordinate) const;

  const Mesh* mesh_;
  Box bounds_;
  std::array<std::size_t, 2> cells_;  // along y and z
  std::array<double, 2> cell_size_;   // [length]
  std::vector<std::size_t> begin_;    // of each cell's triangles
  std::vector<TriangleId> triangles_;
};

enum class Side : std::uint8_t { front, behind, touching };

/// Says where a tip really is, whatever the fixture believed: the check of a simulation.
///
/// Of a closed surface, ray parity tells the inside from the outside: it shares nothing with the
/// fixture. An open one has two sides, those of the nearest point, told by the angle-weighted
/// normal there (Baerentzen, Aanaes, "Signed distance computation using the angle weighted
/// pseudonormal", 2005), which no fixture uses.
///
/// Distances, nearest points, and which triangles a way may meet are not independent: they come
/// from a PD-tree of the audit's own, but of the same make as the fixture's, and from the same
/// closest-point kernel. The tests hold the tree to brute force and the kernel to quadruple
/// precision.
class Audit {
 public:
  /// Depths up to this are touching, not penetration: a tool that slides on a face is, to the last
  /// bits, now above and now below it. [mm]
  static constexpr double touching = 1e-6;

  explicit Audit(std::shared_ptr<const Mesh> mesh);

  SurfaceKind surface() const noexcept { return inside_ ? SurfaceKind::closed : SurfaceKind::open; }

  /// Distance to the surface: negative inside of a closed one, zero when touching. [mm]
  /// `guess` as for NearestTriangle.
  double clearance(const Vec3& point, double guess = 0.0);

  /// On which side of the surface a point is. An open surface has sides only near it.
  Side side(const Vec3& point);

  /// Where the straight way between two points meets triangles, as shares of the way, in order.
  std::vector<double> meetings(const Vec3& from, const Vec3& to);

  Hit nearest(const Vec3& point) { return nearest_(point); }
  const Mesh& mesh() const noexcept { return *mesh_; }

 private:
  bool is_behind_sheet(const Vec3& point, const Hit& nearest);

  std::shared_ptr<const Mesh> mesh_;
  std::unique_ptr<SpatialIndex> index_;
  NearestTriangle nearest_;
  TriangleBuffer candidates_;
  std::optional<InsideTest> inside_;  // only of a watertight mesh
  bool solid_is_outside_ = false;     // wound inwards: the free space is the inside
};

/// Follows a tip and tells when it passes through the surface. It remembers on which side the tip
/// was last seen clear of it: a guarded tool that gets through does so by touching first, and while
/// it touches it is on neither side.
///
/// Around the rim of an open surface a tip may walk freely; one that slides around it in contact is
/// counted as having passed through.
class PathAudit {
 public:
  /// `audit` must outlive this object.
  PathAudit(Audit& audit, const Vec3& start);

  /// Moves straight on to `to`; true if on the way, or at its end, the tip came to be on the other
  /// side of the surface.
  bool follow(const Vec3& to);

 private:
  bool changes_side(Side now);

  Audit* audit_;
  Vec3 at_;
  Side here_;         // at_ is on
  Side side_;         // where the tip was last clear of the surface; touching: nowhere yet
  bool met_ = false;  // the surface, since then
};

}  // namespace keepout::app
