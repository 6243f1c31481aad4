// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <utility>

#include "keepout/geometry/separation.h"

namespace keepout {

/// What a narrow phase says of a pair.
struct NarrowPhaseAnswer {
  Separation separation;     // meaningful only when answered
  std::string_view failure;  // why there is no answer; empty when there is one

  /// Whether there is a separation.
  bool answered() const noexcept { return failure.empty(); }

  /// No answer. `why`: what was wrong; must outlive the answer, as a literal does.
  static NarrowPhaseAnswer failed(std::string_view why) noexcept {
    return {{0.0, Vec3::Zero(), Vec3::Zero()}, why};
  }
};

/// Tells how one tool lies to one triangle after another. Not thread-safe: one for each thread.
///
/// No rule takes an answer at its word, so a wrong one can cost motion but not safety.
class NarrowPhase {
 public:
  virtual ~NarrowPhase() = default;

  /// With the tool's origin at `position`. Ends after a bounded time, whatever the input.
  virtual NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept = 0;
};

/// Whether all numbers are within 1e30 of the origin: what is not, libraries are not asked about.
bool is_in_range(const Vec3& position, const Triangle& triangle) noexcept;

/// The exact kernel: never fails, allocates nothing.
class ExactNarrowPhase final : public NarrowPhase {
 public:
  /// The kernel for one tool.
  explicit ExactNarrowPhase(ConvexTool tool) : tool_(std::move(tool)) {}

  NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept override;

 private:
  ConvexTool tool_;
};

}  // namespace keepout
