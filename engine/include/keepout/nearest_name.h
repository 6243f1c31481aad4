// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace keepout {

/// Of the known names the one that was probably meant by a mistyped one, for "did you mean": the
/// one with the fewest letters put in, left out, exchanged or swapped with their neighbour, if they
/// are at most a third of all; else the first that has all of it in one piece. Capitals count as
/// small letters, '_' as '-'. Of equals the first; nothing if none is close. Allocates.
std::optional<std::string_view> nearest_name(std::string_view mistyped,
                                             std::span<const std::string_view> names);

}  // namespace keepout
