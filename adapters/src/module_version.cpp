// SPDX-License-Identifier: BSD-3-Clause
// A part of each module. Another version of keepout rejects the module.
#include "keepout/version.h"

extern "C" {
[[gnu::visibility("default")]] extern const char keepout_module_version[];
const char keepout_module_version[] = KEEPOUT_VERSION;
}
