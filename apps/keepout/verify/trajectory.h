// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "guard.h"
#include "keepout/fixtures/random.h"
#include "scene.h"
#include "tally.h"

namespace keepout::app {

/// How many incidents of a kind are noted down; all are counted.
inline constexpr std::size_t most_breaches = 1000;
inline constexpr std::size_t most_anomalies = 200;

/// Puts a tip down, asks the guard for `steps` steps, in closed loop, and has each judged. After a
/// breach, and when the tip is stuck, another is put down.
void run_trajectory(Scene& scene, Guard& guard, std::uint64_t number, std::uint64_t steps,
                    Random& random, Tally& tally, Findings& findings);

}  // namespace keepout::app
