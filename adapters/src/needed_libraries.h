// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace keepout {

// The libraries that parts need, for the message about an absent part.
inline constexpr std::string_view needs_fcl =
    "FCL (install keepout-modules; in the sources, install libfcl-dev and set KEEPOUT_WITH_FCL=ON)";
inline constexpr std::string_view needs_bullet =
    "Bullet (install keepout-modules; in the sources, install libbullet-dev and pkg-config and set "
    "KEEPOUT_WITH_BULLET=ON)";
inline constexpr std::string_view needs_ccd =
    "libccd (install keepout-modules; in the sources, install libccd-dev and set "
    "KEEPOUT_WITH_CCD=ON)";

}  // namespace keepout
