// SPDX-License-Identifier: BSD-3-Clause
// Part of each module: keepout of another version refuses it.
#include "keepout/version.h"

extern "C" {
[[gnu::visibility("default")]] extern const char keepout_module_version[];
const char keepout_module_version[] = KEEPOUT_VERSION;
}
