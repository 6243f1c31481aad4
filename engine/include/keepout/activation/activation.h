// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <optional>
#include <span>

#include "keepout/buffer.h"
#include "keepout/geometry/half_space.h"
#include "keepout/index/refine.h"

namespace keepout {

using HalfSpaceBuffer = Buffer<HalfSpace>;

/// What a rule decides from: the tip, and every triangle in reach of the motion.
struct Surroundings {
  Vec3 tip;                   // [length]
  Vec3 desired;               // increment asked for [length]
  double margin;              // distance to keep from the mesh [length], >= 0
  double rounding;            // what the tip may be off by after earlier steps [length]
  std::span<const Hit> hits;  // sorted by id; closest points are relative to the tip
};

/// Decides which planes constrain a motion.
///
/// An eager rule hands over all of its planes in `start`. A lazy one is a separation oracle, as in
/// a cutting-plane method: `separate` is asked about each trial motion, and answers with a plane
/// that the trial violates until it has no objection left. One loop in `step` serves both.
class Activation {
 public:
  virtual ~Activation() = default;

  /// Appends the planes that hold whatever the trial. Must allocate nothing.
  virtual void start(const Surroundings& around, HalfSpaceBuffer& planes) noexcept = 0;

  /// A plane that excludes `trial` and allows standing still, or nothing to accept the trial.
  virtual std::optional<HalfSpace> separate(const Surroundings& /*around*/,
                                            const Vec3& /*trial*/) noexcept {
    return std::nullopt;
  }
};

/// What `step` needs of a rule; a final class that satisfies it is called without dispatch.
template <class T>
concept ActivationRule = requires(T& rule, const Surroundings& around, const Vec3& trial,
                                  HalfSpaceBuffer& planes) {
  requires noexcept(rule.start(around, planes));
  requires noexcept(rule.separate(around, trial));
  { rule.separate(around, trial) } -> std::same_as<std::optional<HalfSpace>>;
};

}  // namespace keepout
