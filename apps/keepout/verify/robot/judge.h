// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/oracle/instrument_oracle.h"
#include "keepout/robot/instrument_constraint.h"

namespace keepout::app {

/// What the judge says of one cycle.
struct RobotVerdict {
  /// Smallest clearance of all bodies at all poses; infinite beyond the margin. [length]
  double least;
  double beyond;       // the same, less what each body was to keep [length]
  bool is_below;       // some body did not keep it, beyond rounding
  bool limits_broken;  // a joint left its limits, or went farther than a cycle admits
};

/// Follows an instrument and holds each cycle to the theorem: no body comes closer than its floor,
/// which is margin - band, or when it was closer already, what it had, less the band; and which
/// never falls.
class RobotJudge {
 public:
  /// Oracle, chain and random numbers must outlive the judge.
  RobotJudge(oracle::InstrumentOracle& oracle, const Chain& chain, Random& random,
             std::span<const double> positions, const InstrumentOptions& options, double tolerance);

  /// From now on these options hold.
  void follow(const InstrumentOptions& options);

  /// The joints go from where they are to `next`, all at once; that is looked at where it begins
  /// and ends, and in four places between.
  RobotVerdict judge(std::span<const double> next);

  /// The smallest clearance of each body at the poses of the last cycle; infinite beyond the
  /// margin. [length]
  std::span<const double> least() const noexcept { return least_; }

  /// Whether no body is closer than margin - band.
  bool is_recovered() const noexcept;

 private:
  void look(std::span<const double> positions, std::span<double> clearances);

  oracle::InstrumentOracle* oracle_;
  const Chain* chain_;
  Random* random_;
  std::vector<double> positions_;
  InstrumentOptions options_;
  double tolerance_;
  std::vector<double> clearances_, floors_;  // of the bodies, where they are [length]
  std::vector<double> least_;                // of the last cycle [length]
};

}  // namespace keepout::app
