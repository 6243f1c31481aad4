// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

namespace keepout {

/// Returns the SIMD targets that the library supports and this processor has, the fastest first.
/// The names are those of Highway: AVX3 (AVX-512), AVX2, SSE4, SSSE3, SSE2. Steps are bitwise
/// identical on each target; only their times differ, so report a time with its target.
std::vector<std::string_view> simd_targets();

/// Returns the target in use: the fastest, unless `use_simd_target` has chosen another.
std::string_view simd_target() noexcept;

/// Selects the target for this process, to measure or test what another processor would do. No
/// other thread may run a step during the call. Throws Error unless simd_targets() has the name.
void use_simd_target(std::string_view name);

}  // namespace keepout
