// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/version.h"

namespace keepout {

std::string_view library_version() noexcept { return KEEPOUT_VERSION; }

}  // namespace keepout
