// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "judge.h"
#include "keepout/step/motion_constraint.h"
#include "scene.h"
#include "shared/columns.h"

namespace keepout::app {

/// What is put to the test: the motion constraint that users get, on one tip after the other. Tests
/// put worse ones in its place.
class Guard {
 public:
  /// The scene must outlive the guard.
  explicit Guard(const Scene& scene);
  virtual ~Guard() = default;

  /// From here on another tip, under other options.
  virtual void begin(const StepOptions& options, Inside inside);

  /// Views in the result stay valid until the next step.
  virtual Step step(const Motion& motion) noexcept;

 private:
  MotionConstraint constraint_;
  SideWatch sides_;
};

/// A part of a campaign: the trajectories whose number, divided by `count`, leaves `index` - 1.
struct Shard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;

  static constexpr std::uint64_t most = 10'000;  // of them; more than anybody has processors for
};

/// What a campaign does. With the same seed, steps and arenas each trajectory is the same, whatever
/// the shards.
struct CampaignSettings {
  std::uint64_t seed = 1;
  std::uint64_t steps = 1'000'000;
  Shard shard = {};
  /// What is attacked; tests put something worse in its place.
  std::function<std::unique_ptr<Guard>(const Scene&)> make_guard =
      std::make_unique<Guard, const Scene&>;
};

/// A tip is followed for so many steps; after a breach, and when it is stuck, another is put down.
inline constexpr std::uint64_t steps_of_a_trajectory = 500;
std::uint64_t trajectory_count(std::uint64_t steps) noexcept;

/// What came out on one mesh.
struct Tally {
  std::string mesh;
  std::uint64_t triangles = 0;  // 0: no trajectory led here, and it was not loaded
  std::uint64_t trajectories = 0;
  std::uint64_t steps = 0;
  std::uint64_t tips = 0;     // put down: anew after a breach, and when stuck
  std::uint64_t led_out = 0;  // steps from the forbidden side, which may cross
  std::array<std::uint64_t, status_count> statuses{};
  std::array<std::uint64_t, breach_kinds> breaches{};
  /// Of all ways of tips that keep their distance, the least beyond it: as it is [length], and in
  /// tau. Infinite when none came near.
  double least = std::numeric_limits<double>::infinity();
  double least_in_tau = std::numeric_limits<double>::infinity();
  double seconds = 0.0;

  /// `kept`: the distance that the tip has to keep. [length]
  void add(const Verdict& verdict, Status status, double kept) noexcept;
};

/// Everything that a campaign, or a part of it, found out. An incident is a JSON object that has
/// everything that is needed to do the step again, every number to its last digit; null for what is
/// not finite.
struct Findings {
  std::vector<Tally> meshes = {};
  Json breaches = Json::array();   // incidents: the first ones
  Json anomalies = Json::array();  // no motion was found though the tip kept its distance
};

/// How many incidents of a kind are noted down; all are counted.
inline constexpr std::size_t most_breaches = 1000;
inline constexpr std::size_t most_anomalies = 200;

/// The answer of an Advanced.
enum class Next : std::uint8_t { go_on, stop };
/// Called by a campaign after each part of it, with the number of its steps and their row.
using Advanced = std::function<Next(std::uint64_t steps, const std::string& row)>;

/// Runs trajectories, in closed loop, and has each step judged: mesh by mesh, so that only one is
/// in memory at a time. `advanced` is called after each. If it stops the campaign, the findings are
/// of those that were run.
Findings run_campaign(const CampaignSettings& settings, std::span<const Arena> arenas,
                      const Advanced& advanced);

}  // namespace keepout::app
