// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
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

/// The step of a tip under test: the motion constraint that users get, for one tip after the other.
/// Tests replace it by sabotaged steps.
class Guard {
 public:
  /// The scene must outlive the guard.
  explicit Guard(const Scene& scene);
  virtual ~Guard() = default;

  /// Begins with another tip and other options.
  virtual void begin(const StepOptions& options, Inside inside);

  /// Returns the step. Its views stay valid until the next step.
  virtual Step step(const Motion& motion) noexcept;

 private:
  MotionConstraint constraint_;
  SideWatch sides_;
};

/// A part of a campaign: the trajectories of each row whose number modulo `count` is `index` - 1.
struct Shard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;

  static constexpr std::uint64_t most = 10'000;  // largest number of shards
};

/// The settings of a campaign: with whole instruments if it names a robot or scenarios, else with
/// tips. The same seed, steps and meshes give the same motions for every number of shards.
struct Campaign {
  // For instruments, for each mesh and each of its row_kinds():
  std::string robot = {};             // see chosen_robot; empty: a robot is drawn for each start
  std::filesystem::path bodies = {};  // of the robot of a URDF file
  std::vector<std::string> scenarios = {};  // of scenarios(); empty: the usual ones
  std::uint64_t cycles = 200'000;
  std::vector<double> speeds{1.0, 5.0};  // multiples of the operator's motion at speed 1
  double rate = 0.0;                     // of the cycles [Hz]; 0: see options_of
  CertifiedMotion motion = CertifiedMotion::actual;
  double margin = 0.2;         // [mm]
  std::uint64_t searched = 0;  // one of this many blocked cycles is searched for a better motion;
                               // 0: 2000, or 100 if mesh or robot are drawn
  // For tips, in total:
  std::uint64_t steps = 1'000'000;

  Shard shard = {};
  std::uint64_t seed = 1;
  /// Create the steps under test.
  std::function<std::unique_ptr<Guard>(const Scene&)> make_guard =
      std::make_unique<Guard, const Scene&>;
  std::function<std::unique_ptr<RobotSubject>(const RobotSetup&)> make_subject = &app::make_subject;
  std::string index = "wide_bvh";
  std::string command = {};  // the command that repeats the campaign

  bool is_of_instruments() const noexcept { return !robot.empty() || !scenarios.empty(); }

  /// A row of an instrument on each mesh.
  struct RowKind {
    const Scenario* scenario;
    double speed;
  };
  /// Returns the rows for each mesh. Named scenarios run at each speed. The first of the usual
  /// scenarios runs at each speed, the others only at the first speed. Throws Error for an unknown
  /// scenario.
  std::vector<RowKind> row_kinds() const;

  /// Returns the number of steps, or cycles, of the shard on `meshes` meshes.
  std::uint64_t length(std::size_t meshes) const;
};

/// Returns the options of a robot in a campaign. Without a rate, the period is long enough for the
/// velocity limits to admit a tenth of a radian and 2.5 mm in a cycle at speed 1.
InstrumentOptions options_of(const Campaign& campaign, const Chain& chain, double speed);

/// The numbers of steps of a trajectory of a tip, and of cycles of a trajectory of an instrument,
/// by default and if its mesh or robot are drawn. A trajectory has its own random numbers, and no
/// other one changes it. A new tip or instrument is placed if it is stuck, a tip also after a
/// breach.
inline constexpr std::uint64_t steps_of_a_trajectory = 500;
inline constexpr std::uint64_t cycles_of_a_trajectory = 2000;
inline constexpr std::uint64_t cycles_of_a_drawn_trajectory = 400;
/// Returns the number of trajectories of at most `length` steps that have this many steps together.
std::uint64_t trajectory_count(std::uint64_t steps, std::uint64_t length) noexcept;

/// The results on one mesh; for instruments, in one scenario at one speed.
struct Tally {
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  std::string mesh = {};
  std::uint64_t triangles = 0;  // 0 if the mesh was not loaded, or is drawn for each start
  std::string scenario = {};    // empty: tips
  double speed = 1.0;
  double period = 0.0;       // of a control cycle; the longest one, if robots are drawn [s]
  std::uint64_t starts = 0;  // of instruments; of tips: trajectories
  std::uint64_t cycles = 0;
  std::uint64_t now = 0;  // number of the current cycle in all shards, from 1
  std::uint64_t startless =
      0;                      // trajectories that ended early: no start of an instrument was found
  std::uint64_t tips = 0;     // that were placed
  std::uint64_t led_out = 0;  // steps from the forbidden side, which may cross the surface
  std::array<std::uint64_t, status_count> statuses{};
  std::array<std::uint64_t, oracle::breach_kinds> breaches{};
  std::uint64_t first_breach = 0;  // number of the first cycle with a breach; 0 without breach
  std::uint64_t in_mesh = 0;    // breaches of the clearance in which the mesh reached into a body
  double deepest = 0.0;         // in those cycles [mm]
  std::uint64_t undecided = 0;  // cycles that the judge neither proved nor refuted
  /// The smallest distance beyond the guaranteed one, as a length and in tolerances. Infinite if
  /// nothing came near. For tips, only steps that must maintain their clearance count. [length]
  double least_beyond = infinity;
  double least_in_tau = infinity;
  double least_guide_in_tau = infinity;  // the same for guides
  /// `blocked`: cycles, except recoveries, that executed less than a twentieth of the commanded
  /// motion. `worse`: cycles whose motion costs over a twentieth more than no motion.
  std::uint64_t blocked = 0, worse = 0;
  std::uint64_t rounds = 0, most_rounds = 0;
  std::uint64_t rows = 0;  // that limited motions, in total
  std::uint64_t most_work_units = 0;
  Timing step = {};              // [µs]
  Timing contact = {};           // of them, those that a body's row limited [µs]
  Timing free = {};              // the others [µs]
  Timing point = {};             // certified step of a ball at the tip, for comparison [µs]
  double excess = 0.0;           // sum over all samples, exact in any order
  std::uint64_t samples = 0;     // blocked cycles that were searched for a better motion
  std::uint64_t useful = 0;      // samples with a motion that is better by more than a twentieth
  std::uint64_t movable = 0;     // samples in which a tenth of the commanded motion was allowed
  std::uint64_t recoveries = 0;  // times that a body was closer than a margin just set
  std::uint64_t recovered = 0;   // recoveries within 500 cycles
  std::uint64_t recovery_cycles = 0;  // cycles of these recoveries
  double seconds = 0.0;

  std::uint64_t operator[](oracle::Breach breach) const {
    return breaches[static_cast<std::size_t>(breach)];
  }
  std::uint64_t broken() const { return std::accumulate(breaches.begin(), breaches.end(), 0ull); }
  /// Counts a breach in the current cycle.
  void count(oracle::Breach breach) {
    ++breaches[static_cast<std::size_t>(breach)];
    if (first_breach == 0) first_breach = now;
  }
};

/// The results of a campaign, or of a part of it. An incident is a JSON object with all values that
/// repeat the step of a tip. Its numbers have all digits, or are null if not finite.
struct Findings {
  std::vector<Tally> rows = {};
  Json breaches = Json::array();   // the first incidents
  Json anomalies = Json::array();  // incidents without a motion although the tip had its clearance
  bool is_complete = true;         // false: the campaign was stopped early
  double seconds = 0.0;            // wall time, including loading [s]
  std::vector<std::string> missing = {};  // meshes that are not in the cache
};

/// The largest numbers of recorded incidents; all incidents are counted.
inline constexpr std::size_t most_breaches = 1000;
inline constexpr std::size_t most_anomalies = 200;

/// The answer of an Advanced function.
enum class Next : std::uint8_t { go_on, stop };
/// Called after each start, with the number of its cycles and the name of their row.
using Advanced = std::function<Next(std::uint64_t cycles, const std::string& row)>;

/// Runs a campaign in closed loop, row by row; a judge examines each step. Only one mesh is in
/// memory at a time. If `advanced` stops it, the findings cover the starts until then. Throws Error
/// for an unknown robot or scenario.
Findings run_campaign(const Campaign& campaign, std::span<const Arena> arenas,
                      const Advanced& advanced);

}  // namespace keepout::app
