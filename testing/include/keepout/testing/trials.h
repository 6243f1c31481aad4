// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <ostream>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "keepout/fixtures/shapes.h"
#include "keepout/simd_target.h"

// NaN and infinity, random trials, generated shapes, SIMD targets, and named cases for tests.

namespace keepout::test {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Returns true if tests make all random trials. `./test --long` sets KEEPOUT_ALL_TRIALS for that.
inline bool all_trials() {
  static const bool all = std::getenv("KEEPOUT_ALL_TRIALS") != nullptr;
  return all;
}

/// Returns true in a short test under sanitizers or without optimization, which takes each path only
/// a few times.
inline bool few_trials() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__OPTIMIZE__)
  return !all_trials();
#else
  return false;
#endif
}

/// Returns how many of `all` random trials a test makes, at least one. A long test makes all of
/// them, a short test a quarter, and a short test under sanitizers or without optimization a tenth. A
/// test scales its expected counts with the same function.
template <class Count>
Count trials(Count all) {
  if (all_trials()) return all;
  const auto share = static_cast<Count>(few_trials() ? 10 : 4);
  if constexpr (std::is_floating_point_v<Count>) return all / share;
  return (all + share - 1) / share;
}

}  // namespace keepout::test

namespace keepout {

/// Prints a shape in the messages of a test.
inline void PrintTo(const Shape& shape, std::ostream* out) { *out << shape.name; }

/// Returns the generated shapes, or every third of them if few trials are enough.
inline std::vector<Shape> shapes_to_try() {
  std::vector<Shape> tried;
  const std::size_t stride = test::few_trials() ? 3 : 1;
  for (std::size_t i = 0; i < shapes().size(); i += stride) tried.push_back(shapes()[i]);
  return tried;
}

/// Returns the names of these shapes, for tests that run once for each.
inline std::vector<std::string> names_of_shapes() {
  std::vector<std::string> names;
  for (const Shape& shape : shapes_to_try()) names.emplace_back(shape.name);
  return names;
}

/// Calls a function on each available SIMD target, the fastest first and the portable one last. If
/// few trials are enough, calls it on these two only. SimdTarget (engine/simd_target_test.cpp)
/// tests the list of targets.
template <class Call>
void on_each_simd_target(Call&& call) {
  struct Restored {
    ~Restored() { use_simd_target(simd_targets().front()); }
  } restored;
  for (const std::string_view target : simd_targets()) {
    const bool is_between = target != simd_targets().front() && target != simd_targets().back();
    if (is_between && test::few_trials()) continue;
    SCOPED_TRACE(std::string(target));
    use_simd_target(target);
    call();
  }
}

/// Names each test of a suite after its parameter, or after the parameter's `name`.
inline constexpr auto by_name = [](const auto& info) {
  if constexpr (requires { info.param.name; }) {
    return std::string(info.param.name);
  } else {
    return std::string(info.param);
  }
};

}  // namespace keepout
