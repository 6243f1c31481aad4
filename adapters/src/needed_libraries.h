// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace keepout {

// What absent parts need.
inline constexpr std::string_view needs_fcl =
    "FCL (install libfcl-dev, configure with KEEPOUT_WITH_FCL=ON)";
inline constexpr std::string_view needs_bullet =
    "Bullet (install libbullet-dev and pkg-config, configure with KEEPOUT_WITH_BULLET=ON)";
inline constexpr std::string_view needs_ccd =
    "libccd (install libccd-dev, configure with KEEPOUT_WITH_CCD=ON)";

}  // namespace keepout
