// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "setup.h"

namespace keepout::app {

/// The smallest margin to ask for: well above what the engine refuses as lost in rounding. [length]
double least_margin(const Scene& scene, double radius) noexcept;

/// Finds a place for the tip, of the kind that the setup asks for. In a gap, the margin is changed
/// to one that all but fills it.
Vec3 place_tip(Scene& scene, Setup& setup, Random& random);

}  // namespace keepout::app
