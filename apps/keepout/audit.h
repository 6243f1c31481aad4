// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "inside_test.h"
#include "keepout/index/nearest.h"
#include "simulation_record.h"

namespace keepout::app {

/// Says where a tip really is, whatever the fixture believed: the independent check of a
/// simulation.
///
/// Of a closed surface, ray parity tells the inside from the outside. An open one has two sides: of
/// its nearest point, told by the angle-weighted normal there (Baerentzen, Aanaes, "Signed distance
/// computation using the angle weighted pseudonormal", 2005). Distances come from an index of the
/// audit's own.
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

  /// Whether the straight way between two points passes through the surface: whether it comes to be
  /// on the other side of it, even if only in between.
  bool crosses(const Vec3& from, const Vec3& to);

  Hit nearest(const Vec3& point) { return nearest_(point); }
  const Mesh& mesh() const noexcept { return *mesh_; }

 private:
  bool is_behind(const Vec3& point);
  bool is_behind_sheet(const Vec3& point, const Hit& nearest);
  void find_meetings(const Vec3& from, const Vec3& to);

  std::shared_ptr<const Mesh> mesh_;
  std::unique_ptr<SpatialIndex> index_;
  NearestTriangle nearest_;
  TriangleBuffer candidates_;
  std::vector<double> meetings_;      // of a way with triangles, as shares of it, sorted
  std::optional<InsideTest> inside_;  // only of a watertight mesh
  bool solid_is_outside_ = false;     // wound inwards: the free space is the inside
};

}  // namespace keepout::app
