// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Before version 0.3 the name of diagnostics.h.
#include "keepout/mesh/diagnostics.h"
