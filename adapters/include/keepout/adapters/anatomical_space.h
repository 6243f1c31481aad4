// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// Which way the axes of a patient's coordinates point. RAS: x to the right, y to the front, z to
/// the head. LPS: x to the left, y to the back, z to the head. One is the other turned by half a
/// turn about z, so a mesh in the wrong one looks sound and is somewhere else.
enum class AnatomicalSpace : std::uint8_t { unstated, ras, lps };

/// "RAS", "LPS", or "unstated".
std::string_view name(AnatomicalSpace space) noexcept;

/// Turns coordinates from RAS to LPS, or back: x and y change signs, exactly. The winding stays.
void swap_ras_and_lps(Surface& surface) noexcept;

}  // namespace keepout
