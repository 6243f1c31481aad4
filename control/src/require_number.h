// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "keepout/option_table.h"

namespace keepout {

/// Throws Error, naming the number, its range and its value, unless it is within the range.
inline void require_number(std::string_view name, double value, const Range& range) {
  OptionText{name, {}, OptionKind::number, {}, range}.accepted(value);
}

}  // namespace keepout
