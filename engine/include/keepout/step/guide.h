// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "keepout/geometry/pose.h"
#include "keepout/geometry/region.h"

namespace keepout {

/// A guidance constraint (guidance virtual fixture) that keeps a tip, or a part of an instrument,
/// in a convex region. Several guides may act together. Each guide holds on the whole executed
/// motion: no motion leaves the region by more than the guide's band. The clearance from meshes has
/// priority over all guides.
///
/// If guides and clearance contradict each other, guides first stop pulling back points that are
/// outside their regions. Then the recovery of clearance slows down: see Relaxation.
class Guide {
 public:
  static constexpr std::size_t most = 16;  // of a tip or an instrument

  /// The kind of guided quantity: a point, the direction of an axis, or the point of a shaft that
  /// is nearest to the region.
  enum class Kind : std::uint8_t { point, axis, shaft };

  /// Returns a guide for the tip of a MotionConstraint. `region`: in the world
  /// (docs/conventions.md). Like all functions below, throws Error for a number that is not finite
  /// or out of range.
  static Guide point(std::string name, const Region& region);

  /// Returns a guide for a point that a link of an instrument carries.
  static Guide point(std::string name, const LinkPoint& point, const Region& region);

  /// Returns a guide that keeps an axis of a link within `angle` (up to 3) [rad] of a direction in
  /// the world. `axis`: a direction in the link's frame.
  static Guide axis(std::string name, int link, const Vec3& axis, const Vec3& direction,
                    double angle);

  /// Returns a guide for a remote center of motion (RCM): the straight shaft between two points
  /// passes within `tolerance` of a place such as a trocar. The points may be on different links.
  /// [length]
  static Guide remote_center(std::string name, const LinkPoint& from, const LinkPoint& to,
                             const Vec3& center, double tolerance);

  /// Returns three guides, one for each axis, that keep the orientation of a link within `angle` of
  /// `rotation`, given in the world. [rad]
  static std::vector<Guide> orientation(const std::string& name, int link, const Mat3& rotation,
                                        double angle);

  /// Returns the name, for messages and records.
  const std::string& name() const noexcept { return name_; }
  /// Returns the region; of an axis, it bounds the tips of unit vectors.
  const Region& region() const noexcept { return region_; }
  /// Returns the kind of guided quantity.
  Kind kind() const noexcept { return kind_; }
  /// Returns true if the guide bounds a direction and not a place: its excess is then almost an
  /// angle. [rad]
  bool is_angular() const noexcept { return kind_ == Kind::axis; }
  /// Returns the curvature allowance: by how much a motion may leave the region. [length, or rad]
  double band() const noexcept { return band_; }
  /// Returns the same guide with another band. Throws Error unless it is above 0.
  Guide with_band(double band) const;

  /// Returns the guided point, the unit direction of an axis, or the first point of a shaft.
  const LinkPoint& first() const noexcept { return first_; }
  /// Returns the second point of a shaft; else the first.
  const LinkPoint& second() const noexcept { return second_; }
  /// Returns the last link that the guide depends on.
  int link() const noexcept;

 private:
  Guide(Kind kind, std::string name, const LinkPoint& first, const LinkPoint& second,
        const Region& region);

  Kind kind_;
  std::string name_;
  LinkPoint first_;
  LinkPoint second_;
  Region region_;
  double band_;
};

/// The constraints that a cycle relaxed because they contradict each other. The point of a relaxed
/// guide moves no farther out than the band.
enum class Relaxation : std::uint8_t {
  none,  // only the task was compromised
  /// Guides do not pull back points outside their regions (see GuideState::relaxed), or points may
  /// use the whole band of a guide.
  guides,
  recovery  // in addition, the tip or bodies recover clearance more slowly than options.recovery
};

/// Returns the name of the enumerator, for files and logs.
std::string_view name(Relaxation relaxation) noexcept;

/// The state of a guide in a cycle.
struct GuideState {
  double excess = 0.0;   // of the region at the start of the cycle; below 0 inside [length or rad]
  bool limits = false;   // true if the guide limits the motion
  bool relaxed = false;  // true if the guide does not pull its point back: infeasible or too costly
};

}  // namespace keepout
