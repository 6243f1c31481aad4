// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

namespace keepout {

/// The instruction sets which the library was built for and this processor has, the fastest first:
/// such as AVX3, AVX2, SSE4, SSSE3, SSE2, as Highway names them (AVX3 is AVX-512). Steps are the
/// same on each, bit for bit; only their times differ, so a figure without its target says little.
std::vector<std::string_view> simd_targets();

/// The one that everything runs on: the fastest, unless `use_simd_target` chose another.
std::string_view simd_target() noexcept;

/// Runs everything in this process on that one from now on: to time what another processor would
/// do, or to test it. Not while another thread steps. Throws Error unless it is among
/// simd_targets().
void use_simd_target(std::string_view name);

}  // namespace keepout
