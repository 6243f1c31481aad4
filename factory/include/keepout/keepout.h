// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Includes all that most programs need: constraints for a tip and for a whole instrument.
// docs/glossary.md explains the terms of the headers.
#include "keepout/error.h"
#include "keepout/factory/convex_tool_text.h"
#include "keepout/factory/guide_text.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/robot/denavit_hartenberg.h"
