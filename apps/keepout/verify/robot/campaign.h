// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "keepout/robot/instrument_constraint.h"
#include "shared/timing.h"
#include "verify/campaign.h"
#include "verify/robot/robot_setup.h"
#include "verify/robot/subject.h"

namespace keepout::app {

/// What a campaign with a whole instrument does.
struct RobotCampaign {
  std::string robot = {};  // of robots_under_test(); empty: one is drawn anew for each start
  std::vector<std::string> scenarios = {};  // of scenarios(); none: the usual ones
  std::uint64_t cycles = 200'000;           // of each row
  std::vector<double> speeds{1.0, 5.0};     // multiples of what a hand at speed 1 asks for
  CertifiedMotion motion = CertifiedMotion::actual;
  double margin = 0.2;  // [mm]
  std::uint64_t seed = 1;
  /// Makes the step that is attacked. Tests replace it by a sabotaged one.
  std::function<std::unique_ptr<RobotSubject>(const RobotSetup&)> make_subject = &app::make_subject;
};

/// The rows for each mesh: scenarios that are named at each speed; of the usual ones the first at
/// each speed, the others at the first speed only. Throws Error for a scenario that there is not.
std::vector<std::pair<const Scenario*, double>> rows_of(const RobotCampaign& campaign);

/// How a robot is guarded in a campaign. Velocity limits are those of a patient arm: the cycle is
/// made so long that they admit a tenth of a radian and 2.5 mm at speed 1.
InstrumentOptions options_of(const RobotCampaign& campaign, const Chain& chain, double speed);

/// What came out on one mesh, in one scenario at one speed.
struct RobotTally {
  std::string mesh;
  std::uint64_t triangles = 0;
  std::string scenario;
  double speed = 1.0;
  double period = 0.0;  // of a control cycle; of the last robot, if robots are drawn [s]
  std::uint64_t starts = 0;
  std::uint64_t cycles = 0;
  bool is_out_of_starts = false;  // no other place was found where one can begin
  std::uint64_t below = 0;        // cycles that came closer than was to be kept
  std::uint64_t in_mesh = 0;      // of them, those in which a body reached through the surface
  double deepest = 0.0;           // of those [mm]
  std::uint64_t limits_broken = 0;
  std::uint64_t guides_left = 0;  // cycles that left a guide by more than is promised
  /// Cycles without anything in the way (status free) that ended farther from what was asked than
  /// standing still, by more than a twentieth, with the true motion of the flange: a breach.
  std::uint64_t strayed = 0;
  std::uint64_t first_breach = 0;  // the number of the first cycle of the row with a breach; or 0
  /// Of all cycles, the smallest clearance beyond what was to be kept. Infinite when none came
  /// near. [mm]
  double least_beyond = std::numeric_limits<double>::infinity();
  double least_in_tau = std::numeric_limits<double>::infinity();        // the same in tolerances
  double least_guide_in_tau = std::numeric_limits<double>::infinity();  // of guides
  std::array<std::uint64_t, status_count> statuses{};
  /// Cycles that led nothing out, and made less than a twentieth of the motion asked for, or one
  /// that costs more than none at all, by a twentieth.
  std::uint64_t blocked = 0, worse = 0;
  std::uint64_t rounds = 0, most_rounds = 0;
  std::uint64_t rows = 0;  // that held motions back, in all
  std::uint64_t most_looks = 0;
  Timing step = {};              // [us]
  Timing point = {};             // of the certified step of a ball at the tip, beside each [us]
  double excess = 0.0;           // of all samples
  std::uint64_t samples = 0;     // blocked cycles that were searched for a better motion
  std::uint64_t useful = 0;      // of them, those where there was one worth the name
  std::uint64_t movable = 0;     // of them, those where a tenth of the motion asked for was allowed
  std::uint64_t recoveries = 0;  // how often a body was closer than a margin just set
  std::uint64_t recovered = 0;   // of them, within 500 cycles
  std::uint64_t recovery_cycles = 0;  // that those took
  double seconds = 0.0;
};

/// How long the steps of a row took. [us]
struct RobotTimes {
  std::vector<double> step = {}, point = {};  // see RobotTally
};

/// Runs an instrument from a start for at most `cycles` cycles, judges each, and adds them to the
/// row. Ends early if no motion can be proved for 50 cycles.
void run_attempt(const RobotCampaign& campaign, RobotSetup setup, Random& random,
                 std::uint64_t cycles, RobotTally& tally, RobotTimes& times);

/// Runs it, all rows on one mesh after the other. `advanced` is called after each start. If it
/// stops the campaign, the rows are of what was done. Throws Error when there is no such robot.
std::vector<RobotTally> run_campaign(const RobotCampaign& campaign, std::span<const Arena> arenas,
                                     const Advanced& advanced);

/// How many cycles that is on so many meshes.
std::uint64_t cycle_count(const RobotCampaign& campaign, std::size_t meshes);

/// Cycles in which something that is promised was not kept.
std::uint64_t breaches(const RobotTally& tally) noexcept;

}  // namespace keepout::app
