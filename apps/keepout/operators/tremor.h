// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "keepout/fixtures/random.h"

namespace keepout::app {

/// A smooth tremor: the sum of three waves, each with its own direction and frequency.
class Tremor {
 public:
  /// `amplitude`: root of the sum of the squared amplitudes of the waves. [mm]
  Tremor(double amplitude, Random& random) : amplitude_(amplitude) {
    for (Wave& wave : waves_) {
      wave = {random.direction(), random.uniform(8.0, 12.0), random.uniform(0.0, 1.0)};
    }
  }

  Vec3 at(double seconds) const {
    Vec3 sum = Vec3::Zero();
    for (const Wave& wave : waves_) {
      sum += wave.direction *
             std::sin(2.0 * std::numbers::pi * (wave.frequency * seconds + wave.phase));
    }
    return amplitude_ / std::sqrt(3.0) * sum;
  }

 private:
  struct Wave {
    Vec3 direction;
    double frequency;  // [Hz]
    double phase;      // [turns]
  };
  double amplitude_;
  std::array<Wave, 3> waves_;
};

}  // namespace keepout::app
