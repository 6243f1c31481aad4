// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>

namespace keepout::test {

/// Whether few random trials are enough: under sanitizers, where what counts is that every path is
/// taken and not how often; unless KEEPOUT_ALL_TRIALS is set, as `./test --long` does.
inline bool few_trials() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  static const bool few = std::getenv("KEEPOUT_ALL_TRIALS") == nullptr;
  return few;
#else
  return false;
#endif
}

/// How many of so many random trials are made: all of them, or a tenth and at least one. What a
/// test expects to have seen in them is told in the same way.
template <class Count>
Count trials(Count all) {
  return few_trials() ? static_cast<Count>((all + 9) / 10) : all;
}

}  // namespace keepout::test
