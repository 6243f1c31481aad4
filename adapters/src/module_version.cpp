// SPDX-License-Identifier: BSD-3-Clause
// A part of each module. Another version of keepout rejects the module.
#include "keepout/module.h"

KEEPOUT_MODULE();
