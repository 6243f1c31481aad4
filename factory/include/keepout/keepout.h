// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// All that a program needs which takes keepout as it comes.
#include "keepout/error.h"
#include "keepout/factory/convex_tool_text.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/mesh/load_mesh.h"
