// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "keepout/geometry/region.h"
#include "keepout/robot/instrument.h"
#include "keepout/step/guide_state.h"

namespace keepout {

/// Where something of an instrument is to stay, whatever the hand asks for: a virtual fixture that
/// is no mesh. Guides compose: each is kept on the whole true motion of the joints, as bodies are
/// kept off the mesh, and never left by more than its band.
///
/// Where guides and bodies contradict each other, first the guides stop leading back what is out,
/// then the bodies lead off by less; nothing of them gets worse, and what gave way is told
/// (InstrumentStep::softening, GuideState).
class Guide {
 public:
  static constexpr std::size_t most = 16;  // of an instrument

  /// A point that a link carries stays in a region: tip in a corridor, in a tube about a planned
  /// line, on one side of a plane. Like those below it throws Error for a number that is none.
  static Guide point(std::string name, const LinkPoint& point, const Region& region);

  /// An axis of a link, a direction in the link's frame, stays within `angle` (up to 3) of a
  /// direction in the mesh's. [rad]
  static Guide axis(std::string name, int link, const Vec3& axis, const Vec3& direction,
                    double angle);

  /// The remote centre of motion: the straight shaft between two points passes within `tolerance`
  /// of a place, such as a trocar. The points may be on different links. [length]
  static Guide remote_center(std::string name, const LinkPoint& from, const LinkPoint& to,
                             const Vec3& center, double tolerance);

  /// A link keeps an orientation, in the mesh's frame, to within `angle` of any turn: a guide for
  /// each of its axes. [rad]
  static std::vector<Guide> orientation(const std::string& name, int link, const Mat3& rotation,
                                        double angle);

  /// For messages and records.
  const std::string& name() const noexcept { return name_; }
  /// In which it is to stay: of an axis, the tips of unit vectors.
  const Region& region() const noexcept { return region_; }
  /// Whether it is about a direction and not a place: then what is told is in radians, all but.
  bool is_angular() const noexcept { return kind_ == Kind::axis; }
  /// By how much the region may be left, which curvature needs: see InstrumentOptions::band.
  /// [length, or rad]
  double band() const noexcept { return band_; }
  /// The same guide with another band. Throws Error unless it is above 0.
  Guide with_band(double band) const;

  /// The link beyond which no joint matters to it.
  int link() const noexcept;
  /// What is to stay in the region, as the chain is.
  Vec3 place(const ChainState& state) const noexcept;
  /// The nearest share from its first point to its second; 0 of what has only one.
  double share(const ChainState& state) const noexcept;
  /// How the place moves with joint k, which a shaft may slide through. [1 / unit of the joint]
  Vec3 derivative(const ChainState& state, int k) const noexcept;
  /// What bounds the second derivative of its place while the joints move by dq on a straight line,
  /// the chain being in `state` as they begin; `slide`: of the share.
  double bend(const ChainState& state, std::span<const double> increment,
              double slide) const noexcept;

 private:
  enum class Kind : std::uint8_t { point, axis, shaft };

  Guide(Kind kind, std::string name, const LinkPoint& first, const LinkPoint& second,
        const Region& region);

  Kind kind_;
  std::string name_;
  LinkPoint first_;   // of an axis: its direction, of length 1
  LinkPoint second_;  // of a shaft
  Region region_;
  double band_;
};

}  // namespace keepout
