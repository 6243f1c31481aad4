// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

namespace keepout {

/// A unit that the numbers of a file may be in.
struct UnitGuess {
  std::string_view unit;  // "m", "cm", "in", "um"
  double millimetres;     // that one is
};

/// The units other than millimetres in which something of that largest extent would be of the size
/// that organs have, 20 to 600 mm. A size that is usual in millimetres has none: from 30 on.
std::vector<UnitGuess> other_units(double extent);

}  // namespace keepout
