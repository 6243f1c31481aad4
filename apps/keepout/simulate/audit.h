// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "keepout/index/query.h"
#include "keepout/oracle/inside_test.h"
#include "keepout/oracle/triangle_tree.h"

namespace keepout::app {

enum class SurfaceKind : std::uint8_t { closed, open };
enum class Side : std::uint8_t { front, behind, touching };

/// Says where a tip really is, whatever the fixture believed: the check of a simulation.
///
/// Distances, and which side of a closed surface a point is on, come from the oracle, which shares
/// nothing with the fixture. An open surface has two sides, those of the nearest point, told by the
/// angle-weighted normal there (Baerentzen, Aanaes, "Signed distance computation using the angle
/// weighted pseudonormal", 2005), which no fixture uses; but the nearest point itself is found by
/// the closest-point kernel that fixtures use, which the tests hold to quadruple precision.
class Audit {
 public:
  /// Depths up to this are touching, not penetration: a tool that slides on a face is, to the last
  /// bits, now above and now below it. [mm]
  static constexpr double touching = 1e-6;

  explicit Audit(std::shared_ptr<const Mesh> mesh);

  SurfaceKind surface() const noexcept { return inside_ ? SurfaceKind::closed : SurfaceKind::open; }

  /// Distance to the surface, on whichever side. [mm]
  double distance(const Vec3& point) const { return tree_->nearest(point).distance.estimate; }

  /// On which side of the surface a point is. An open surface has sides only near it.
  Side side(const Vec3& point) { return side(point, distance(point)); }
  Side side(const Vec3& point, double distance);

  /// Distance to the surface: negative inside of a closed one, zero when touching it. [mm]
  double clearance(const Vec3& point);
  double clearance(double distance, Side side) const noexcept;

  /// Where the straight way between two points meets triangles, as shares of the way, in order.
  std::vector<double> meetings(const Vec3& from, const Vec3& to);

  /// The nearest triangle, of equally near ones the first, and its closest point.
  Hit nearest(const Vec3& point);
  const Mesh& mesh() const noexcept { return *mesh_; }
  /// Returns the tree of the mesh's triangles, for other judges.
  const std::shared_ptr<const oracle::TriangleTree>& tree() const noexcept { return tree_; }

 private:
  bool is_behind_sheet(const Vec3& point);

  std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<const oracle::TriangleTree> tree_;
  std::optional<oracle::InsideTest> inside_;  // only of a watertight mesh
  std::vector<TriangleId> candidates_;        // of the last search
  bool solid_is_outside_ = false;             // wound inwards: the free space is the inside
};

/// Follows a tip and tells when it passes through the surface. It remembers on which side the tip
/// was last seen clear of it: a guarded tool that gets through does so by touching first, and while
/// it touches it is on neither side.
///
/// Around the rim of an open surface a tip may traversal freely; one that slides around it in
/// contact is counted as having passed through.
class PathAudit {
 public:
  /// `audit` must outlive this object.
  PathAudit(Audit& audit, const Vec3& start);

  /// Moves straight on to `to`; true if on the way, or at its end, the tip came to be on the other
  /// side of the surface.
  bool follow(const Vec3& to);

  /// Of where the tip is now: see Audit::clearance. [mm]
  double clearance() const noexcept { return audit_->clearance(distance_, here_); }

 private:
  bool changes_side(Side now);

  Audit* audit_;
  Vec3 at_;
  double distance_;   // of at_ from the surface [mm]
  Side here_;         // at_ is on
  Side side_;         // where the tip was last clear of the surface; touching: nowhere yet
  bool met_ = false;  // the surface, since then
};

}  // namespace keepout::app
