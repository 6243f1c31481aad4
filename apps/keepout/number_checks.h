// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace keepout::app {

/// Above it, whole numbers are not read back as they were written.
inline constexpr std::uint64_t largest_seed = (std::uint64_t{1} << 63) - 1;

enum class Zero { allowed, refused };

/// A length in millimetres. CLI11's own checks let 'nan' pass and tell their range in 300 digits.
/// The limit keeps squares of lengths, and sums of them, far from the end of a double's range.
CLI::Validator length(Zero zero);

/// A whole number in decimal digits. For transform(), which hands on what was read: CLI11 alone
/// would take '-1' for 2^64 - 1, too many digits for the largest number, and '010' for 8.
CLI::Validator whole_number(std::uint64_t low, std::uint64_t high);

/// A count such as 20000 or 1e8. For transform(), which hands on its digits.
CLI::Validator large_count();

}  // namespace keepout::app
