// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Before version 0.3 the name of motion_traversal.h.
#include "keepout/index/motion_traversal.h"

namespace keepout {
using MotionWalk [[deprecated("use MotionTraversal")]] = MotionTraversal;
}
