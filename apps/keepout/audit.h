// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "inside_test.h"
#include "keepout/index/nearest.h"
#include "simulation_record.h"

namespace keepout::app {

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

}  // namespace keepout::app
