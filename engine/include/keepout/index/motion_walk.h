// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Deprecated name of motion_traversal.h, from before version 0.3.
#include "keepout/index/motion_traversal.h"

namespace keepout {
/// The name of MotionTraversal before version 0.3.
using MotionWalk [[deprecated("use MotionTraversal")]] = MotionTraversal;
}  // namespace keepout
