// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "keepout/judges/tip_judge.h"
#include "keepout/step/motion_constraint.h"
#include "shared/columns.h"
#include "shared/timing.h"
#include "verify/robot/subject.h"
#include "verify/scene.h"

namespace keepout::app {

/// The step of a tip under test: the motion constraint that users get, on one tip after the other.
/// Tests replace it by sabotaged ones.
class Guard {
 public:
  /// The scene must outlive the guard.
  explicit Guard(const Scene& scene);
  virtual ~Guard() = default;

  /// Begins with another tip, under other options.
  virtual void begin(const StepOptions& options, Inside inside);

  /// Views in the result stay valid until the next step.
  virtual Step step(const Motion& motion) noexcept;

 private:
  MotionConstraint constraint_;
  SideWatch sides_;
};

/// A part of a campaign with tips: the trajectories whose number, divided by `count`, leaves
/// `index` - 1.
struct Shard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;

  static constexpr std::uint64_t most = 10'000;  // shards; more than anybody has processors for
};

/// The settings of a campaign: with whole instruments if it names a robot or scenarios, else with
/// tips.
/// The same seed, steps and meshes give the same motions, whatever the shards.
struct Campaign {
  // With instruments, for each mesh and row_kinds() of it:
  std::string robot = {};  // of robots_under_test(); empty: a robot is drawn for each start
  std::vector<std::string> scenarios = {};  // of scenarios(); empty: the usual ones
  std::uint64_t cycles = 200'000;
  std::vector<double> speeds{1.0, 5.0};  // multiples of the motion that a hand commands at speed 1
  CertifiedMotion motion = CertifiedMotion::actual;
  double margin = 0.2;         // [mm]
  std::uint64_t searched = 0;  // one in so many blocked cycles is searched for a better motion;
                               // 0: 2000, and 100 if mesh or robot are drawn
  // With tips, in all:
  std::uint64_t steps = 1'000'000;
  Shard shard = {};

  std::uint64_t seed = 1;
  /// Make the steps under test.
  std::function<std::unique_ptr<Guard>(const Scene&)> make_guard =
      std::make_unique<Guard, const Scene&>;
  std::function<std::unique_ptr<RobotSubject>(const RobotSetup&)> make_subject = &app::make_subject;
  std::string index = "wide_bvh";
  std::string command = {};  // that repeats the campaign

  bool is_of_instruments() const noexcept { return !robot.empty() || !scenarios.empty(); }

  /// A row of an instrument on each mesh.
  struct RowKind {
    const Scenario* scenario;
    double speed;
  };
  /// Returns the rows for each mesh: scenarios that are named at each speed; of the usual ones the
  /// first at each speed, the others at the first speed only. Throws Error for an unknown scenario.
  std::vector<RowKind> row_kinds() const;

  /// Returns the number of steps, or cycles, of the shard on so many meshes.
  std::uint64_t length(std::size_t meshes) const;
};

/// Returns the options of a robot in a campaign. Its velocity limits are those of a patient arm:
/// the cycle is so long that they admit a tenth of a radian and 2.5 mm at speed 1.
InstrumentOptions options_of(const Campaign& campaign, const Chain& chain, double speed);

/// A tip is followed for so many steps. A new tip is placed after a breach, and for one that is
/// stuck.
inline constexpr std::uint64_t steps_of_a_trajectory = 500;
std::uint64_t trajectory_count(std::uint64_t steps) noexcept;

/// The results on one mesh; of instruments in one scenario at one speed.
struct Tally {
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  std::string mesh = {};
  std::uint64_t triangles = 0;  // 0: the mesh was not loaded, or is drawn for each start
  std::string scenario = {};    // empty: tips
  double speed = 1.0;
  double period = 0.0;       // of a control cycle; of the last robot, if robots are drawn [s]
  std::uint64_t starts = 0;  // of instruments; of tips: trajectories
  std::uint64_t cycles = 0;
  bool is_out_of_starts = false;  // no other place was found where an instrument can begin
  std::uint64_t tips = 0;         // that were placed
  std::uint64_t led_out = 0;      // steps from the forbidden side, which may cross
  std::array<std::uint64_t, status_count> statuses{};
  std::array<std::uint64_t, oracle::breach_kinds> breaches{};
  std::uint64_t first_breach = 0;  // the number of the first cycle with a breach; or 0
  std::uint64_t in_mesh = 0;       // cycles too near in which the mesh reached into a body
  double deepest = 0.0;            // in those cycles [mm]
  /// The smallest distance beyond the promised one: as it is [length], and in tolerances. Infinite
  /// if nothing came near. Of tips, only those count that keep their distance.
  double least_beyond = infinity;
  double least_in_tau = infinity;
  double least_guide_in_tau = infinity;  // of guides
  /// Cycles, but for recoveries, that made less than a twentieth of the commanded motion; and those
  /// whose motion costs more than none, by a twentieth.
  std::uint64_t blocked = 0, worse = 0;
  std::uint64_t rounds = 0, most_rounds = 0;
  std::uint64_t rows = 0;  // that limited motions, in all
  std::uint64_t most_work_units = 0;
  Timing step = {};              // [us]
  Timing point = {};             // of the certified step of a ball at the tip, beside each [us]
  double excess = 0.0;           // of all samples
  std::uint64_t samples = 0;     // blocked cycles for which a better motion was searched
  std::uint64_t useful = 0;      // of them, those with a better motion by more than a twentieth
  std::uint64_t movable = 0;     // of them, those where a tenth of the commanded motion was allowed
  std::uint64_t recoveries = 0;  // how often a body was closer than a margin just set
  std::uint64_t recovered = 0;   // of them, within 500 cycles
  std::uint64_t recovery_cycles = 0;  // that those took
  double seconds = 0.0;

  std::uint64_t operator[](oracle::Breach breach) const {
    return breaches[static_cast<std::size_t>(breach)];
  }
  std::uint64_t broken() const { return std::accumulate(breaches.begin(), breaches.end(), 0ull); }
  /// Counts a breach in the cycle that was counted last.
  void count(oracle::Breach breach) {
    ++breaches[static_cast<std::size_t>(breach)];
    if (first_breach == 0) first_breach = cycles;
  }
};

/// The results of a campaign, or of a part of it. An incident is a JSON object with everything that
/// is needed to repeat the step of a tip, every number with all its digits; null if not finite.
struct Findings {
  std::vector<Tally> rows = {};
  Json breaches = Json::array();          // incidents: the first ones
  Json anomalies = Json::array();         // no motion was found though the tip kept its distance
  bool is_complete = true;                // false: the campaign was stopped before its end
  double seconds = 0.0;                   // wall time, loading included
  std::vector<std::string> missing = {};  // meshes that are not in the cache
};

/// The largest numbers of incidents that are recorded; all are counted.
inline constexpr std::size_t most_breaches = 1000;
inline constexpr std::size_t most_anomalies = 200;

/// The answer of an Advanced.
enum class Next : std::uint8_t { go_on, stop };
/// Called by a campaign after each start, with the number of its cycles and their row.
using Advanced = std::function<Next(std::uint64_t cycles, const std::string& row)>;

/// Runs a campaign in closed loop, row by row, and has each step judged. Only one mesh is in memory
/// at a time. If `advanced` stops it, the findings are of the starts until then. Throws Error for
/// an unknown robot or scenario.
Findings run_campaign(const Campaign& campaign, std::span<const Arena> arenas,
                      const Advanced& advanced);

}  // namespace keepout::app
