// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "keepout/index/query.h"
#include "keepout/monitor/triangle_tree.h"
#include "keepout/oracle/inside_test.h"

namespace keepout::app {

enum class SurfaceKind : std::uint8_t { closed, open };
enum class Side : std::uint8_t { front, behind, touching };

/// Computes where a tip really is, independently of its guard: the judge of a simulation.
///
/// Distances, and the side of a closed surface, come from the oracle, which shares no code with the
/// guard. The sides of an open surface are those of its nearest point. The angle-weighted normal
/// there decides the side (Baerentzen, Aanaes, "Signed distance computation using the angle
/// weighted pseudonormal", 2005), and no guard uses that. The nearest point itself comes from the
/// closest-point kernel that guards use, which the tests compare with quadruple precision.
class Audit {
 public:
  /// A depth up to this counts as touching, not as penetration: rounding puts a tool that slides on
  /// a face alternately above and below it. [mm]
  static constexpr double touching = 1e-6;

  explicit Audit(std::shared_ptr<const Mesh> mesh);

  SurfaceKind surface() const noexcept { return inside_ ? SurfaceKind::closed : SurfaceKind::open; }

  /// Returns the unsigned distance to the surface. [mm]
  double distance(const Vec3& point) const {
    return tree_->nearest(point, oracle::narrow_distance).distance.estimate;
  }

  /// Returns the side of the surface that a point is on. An open surface has sides only near it.
  Side side(const Vec3& point) { return side(point, distance(point)); }
  Side side(const Vec3& point, double distance);

  /// Returns the distance to the surface: negative inside a closed one, zero when touching it. [mm]
  double clearance(const Vec3& point);
  double clearance(double distance, Side side) const noexcept;

  /// Returns where the straight segment between two points meets triangles, as sorted fractions of
  /// the segment.
  std::vector<double> meetings(const Vec3& from, const Vec3& to);

  /// Returns the nearest triangle and its closest point; the first of equally near triangles.
  Hit nearest(const Vec3& point);
  const Mesh& mesh() const noexcept { return *mesh_; }
  /// Returns the tree of the mesh's triangles, for other judges.
  const std::shared_ptr<const monitor::TriangleTree>& tree() const noexcept { return tree_; }

 private:
  bool is_behind_sheet(const Vec3& point);

  std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<const monitor::TriangleTree> tree_;
  std::optional<oracle::InsideTest> inside_;  // set for a watertight mesh only
  std::vector<TriangleId> candidates_;        // of the last search
  bool solid_is_outside_ = false;  // the mesh is wound inward: the free space is the inside
};

/// Follows a tip and detects when it passes through the surface. Remembers the side on which the
/// tip was last clear of the surface: a guarded tool that passes through touches the surface first,
/// and is then on neither side.
///
/// A tip may go around the rim of an open surface. If it slides around the rim in contact, it
/// counts as having passed through.
class PathAudit {
 public:
  /// `audit` must outlive this object.
  PathAudit(Audit& audit, const Vec3& start);

  /// Moves straight to `to`. Returns true if the tip reached the other side of the surface, on the
  /// way or at the end.
  bool follow(const Vec3& to);

  /// Returns the clearance of the tip now: see Audit::clearance. [mm]
  double clearance() const noexcept { return audit_->clearance(distance_, here_); }

 private:
  bool changes_side(Side now);

  Audit* audit_;
  Vec3 at_;
  double distance_;  // of at_ from the surface [mm]
  Side here_;        // of the surface, at at_
  Side side_;  // last side where the tip was clear of the surface; `touching` before the first
  bool met_ = false;  // whether the tip has met the surface since then
};

}  // namespace keepout::app
