// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace keepout {

/// Names each test of a suite after its parameter, or after the parameter's `name`.
inline constexpr auto by_name = [](const auto& info) {
  if constexpr (requires { info.param.name; }) {
    return std::string(info.param.name);
  } else {
    return std::string(info.param);
  }
};

}  // namespace keepout
