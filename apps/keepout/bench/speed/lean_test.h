// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/triangle.h"

namespace keepout::app {

/// Whether a triangle touches a ball, as the engine's kernel has it, but decided by the shortest
/// code there is wherever that is sure; the kernel tells features apart, and has its roundings
/// under control, at several times the cost.
///
/// Source: Ericson, "Real-Time Collision Detection", 2005, section 5.1.5.
bool touches_ball(const Triangle& triangle, const Vec3& center, double radius) noexcept;

}  // namespace keepout::app
