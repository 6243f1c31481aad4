// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace keepout::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool under_sanitizers = true;
#else
inline constexpr bool under_sanitizers = false;
#endif

/// How many of so many random trials are made: all of them; under sanitizers, where what counts is
/// that every path is taken and not how often, a fifth, and at least one. What a test expects to
/// have seen in them is told in the same way.
template <class Count>
constexpr Count trials(Count all) {
  return under_sanitizers ? static_cast<Count>((all + 4) / 5) : all;
}

}  // namespace keepout::test
