// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

namespace keepout::oracle {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace keepout::oracle
