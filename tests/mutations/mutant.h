// SPDX-License-Identifier: BSD-3-Clause
//
// Only for the build of `tests/mutations/run`: each changed copy of a source includes it first.
#pragma once

// Changes may look odd to a compiler.
#pragma GCC diagnostic ignored "-Wpragmas"
#pragma GCC diagnostic ignored "-Wparentheses"
#pragma GCC diagnostic ignored "-Wunused-variable"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-value"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Warray-bounds"
#pragma GCC diagnostic ignored "-Wstringop-overflow"
#pragma GCC diagnostic ignored "-Wbool-compare"
#pragma GCC diagnostic ignored "-Wtautological-compare"
#pragma GCC diagnostic ignored "-Wempty-body"
#pragma GCC diagnostic ignored "-Wdangling-else"
#pragma GCC diagnostic ignored "-Wmisleading-indentation"
#pragma GCC diagnostic ignored "-Wtype-limits"
#pragma GCC diagnostic ignored "-Woverflow"

#include <cstdio>
#include <cstdlib>
#include <type_traits>

namespace keepout_mutants {

inline constexpr int most = 2000;

/// Writes the numbers of the mutants whose place was evaluated into a file, when the process ends.
struct Reached {
  char places[most] = {};
  ~Reached() {
    const char* name = std::getenv("KEEPOUT_MUTANTS_REACHED");
    std::FILE* file = name == nullptr ? nullptr : std::fopen(name, "a");
    if (file == nullptr) return;
    for (int i = 0; i < most; ++i) {
      if (places[i] != 0) std::fprintf(file, "%d\n", i);
    }
    std::fclose(file);
  }
};

/// The number of the active mutant: the environment variable KEEPOUT_MUTANT. 0: none. Below 0:
/// none, and each place that is evaluated is noted. Dynamically initialized before the variables of
/// each source that includes this header first.
inline Reached reached;
inline const int active = [] {
  const char* text = std::getenv("KEEPOUT_MUTANT");
  return text == nullptr ? 0 : std::atoi(text);
}();

/// Returns true if the mutant is active.
inline bool is(int mutant) noexcept {
  if (active < 0) reached.places[mutant] = 1;
  return active == mutant;
}

}  // namespace keepout_mutants
