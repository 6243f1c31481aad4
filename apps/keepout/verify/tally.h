// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "incident.h"
#include "judge.h"

namespace keepout::app {

inline constexpr std::size_t status_count = static_cast<std::size_t>(Status::margin_too_small) + 1;

/// What came out on one mesh. Sums of tallies do not depend on the order.
struct Tally {
  std::uint64_t trajectories = 0;
  std::uint64_t steps = 0;
  std::uint64_t tips = 0;     // put down: anew after a breach, and when stuck
  std::uint64_t led_out = 0;  // steps from the forbidden side, which may cross
  std::array<std::uint64_t, status_count> statuses{};
  std::array<std::uint64_t, breach_kinds> breaches{};
  /// Of all ways of tips that keep the margin, the least distance - margin: as it is [length], and
  /// in tau. Infinite when none came near.
  double least = std::numeric_limits<double>::infinity();
  double least_in_tau = std::numeric_limits<double>::infinity();
  double seconds = 0.0;

  std::uint64_t breach_count() const noexcept;
  void add(const Verdict& verdict, Status status, double margin) noexcept;
  Tally& operator+=(const Tally& other) noexcept;
};

/// The tally of a mesh.
struct SceneResult {
  std::string mesh;
  std::uint64_t triangles = 0;  // 0: no trajectory led here, and it was not loaded
  Tally tally = {};
};

/// Everything that a campaign, or a part of it, found out.
struct Findings {
  std::vector<SceneResult> scenes;
  std::vector<Incident> breaches = {};  // the first ones
  std::vector<Incident> anomalies =
      {};  // steps that found no motion though the tip kept its distance

  Tally total() const noexcept;
};

}  // namespace keepout::app
