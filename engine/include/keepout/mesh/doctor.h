// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Deprecated name of diagnostics.h, from before version 0.3.
#include "keepout/mesh/diagnostics.h"
