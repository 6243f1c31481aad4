// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "keepout/activation/activation_rule.h"
#include "keepout/step/guide.h"

namespace keepout {

/// The guides of a tip in a control cycle. They add half-spaces, besides the rule.
///
/// A tip inside a region leaves it by no more than the guide's band; a tip outside moves no farther
/// out. The excess of a straight motion is convex, so its end decides for all of it. A half-space
/// that touches a region excludes only motions that leave the region. So a cycle only adds
/// half-spaces, and never drops them.
class TipGuides {
 public:
  static constexpr std::size_t most_planes_of_a_guide = 8;
  static constexpr std::size_t most_planes = Guide::most * most_planes_of_a_guide;

  TipGuides() : planes_(0) {}
  /// Throws Error for more than Guide::most guides, or a guide that is not of a tip.
  explicit TipGuides(std::vector<Guide> guides);

  std::span<const Guide> guides() const noexcept { return guides_; }
  bool empty() const noexcept { return guides_.empty(); }

  /// Begins a cycle with the half-spaces of the regions that the tip is outside of. They pull the
  /// tip back by up to `recovery`. [length]
  void open(const Vec3& tip, double recovery) noexcept;

  /// Returns true if the tip starts outside a region by more than the guide's band.
  bool is_recovering() const noexcept;
  /// Returns true if a half-space demands motion.
  bool leads_back() const noexcept;
  /// Stops pulling the tip back. Returns true if any half-space changed.
  bool relax() noexcept;

  /// Returns true if a motion leaves no region by more than the guide's band, or by more than at
  /// the start if that is larger.
  bool allow(const Vec3& motion) const noexcept { return empty() || all_allow(motion); }
  /// Returns a fraction of a motion that is allowed, by bisection to 1/1000; 1 if all of it is.
  double allowed_fraction(const Vec3& motion) const noexcept;
  /// Adds a half-space for each region that a motion leaves. Returns false if it adds none.
  bool exclude(const Vec3& motion) noexcept;
  /// Notes that the guides which a motion leaves limit the step.
  void note_left_by(const Vec3& motion) noexcept;
  /// Notes that the guide of a half-space limits the step.
  void note_active(std::size_t plane) noexcept { states_[guide_of_[plane]].limits = true; }

  /// Notes that every guide with a half-space limits the step.
  void note_all_active() noexcept {
    for (std::size_t plane = 0; plane < planes_.size(); ++plane) note_active(plane);
  }

  /// Returns the half-spaces of this cycle; their source is no_triangle.
  std::span<const HalfSpace> planes() const noexcept { return planes_.view(); }
  /// Returns the state of each guide, for a step with this relaxation.
  std::span<const GuideState> states(Relaxation relaxation) noexcept;

 private:
  Vec3 at_end(const Vec3& motion) const noexcept { return tip_ + motion; }
  bool all_allow(const Vec3& motion) const noexcept;
  bool add(std::size_t guide, const Vec3& at) noexcept;

  std::vector<Guide> guides_;
  std::vector<GuideState> states_;
  std::vector<double> most_excess_;  // of each guide in this cycle [length]
  HalfSpaceBuffer planes_;
  std::vector<std::size_t> guide_of_;  // of each half-space
  Vec3 tip_ = Vec3::Zero();
  double recovery_ = 0.0;  // 0 once relaxed [length]
};

}  // namespace keepout
