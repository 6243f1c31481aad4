// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/adapters/index_registry.h"

namespace keepout {

// For tests, benchmarks and the command, which compare all that there is. A program of yours links
// keepout::keepout, and nothing under the GPL: what is linked with CGAL's tree, which is, may be
// passed on under the GPL only. keepout itself never is.

/// index_backends(), then those that stand on libraries under the GPL, if KEEPOUT_WITH_CGAL is ON.
Registry<IndexBackend> all_index_backends();

}  // namespace keepout
