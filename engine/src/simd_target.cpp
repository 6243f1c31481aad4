// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/simd_target.h"

#include <hwy/highway.h>

#include <bit>
#include <cstdint>
#include <string>

#include "keepout/error.h"

namespace keepout {
namespace {

/// Returns a bit for each target that can be chosen; the lowest is the fastest.
std::uint64_t supported() noexcept {
  return static_cast<std::uint64_t>(hwy::SupportedTargets() & HWY_TARGETS);
}

void choose(std::uint64_t targets) noexcept {
  hwy::SetSupportedTargetsForTest(static_cast<std::int64_t>(targets));
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

/// Returns a bit for each target of this processor, whatever was chosen.
std::uint64_t all() noexcept {
  const auto chosen = static_cast<std::uint64_t>(hwy::SupportedTargets());
  hwy::SetSupportedTargetsForTest(0);
  const std::uint64_t there = supported();
  choose(chosen);
  return there;
}

std::string_view name_of_lowest(std::uint64_t targets) noexcept {
  return hwy::TargetName(static_cast<std::int64_t>(targets & -targets));
}

}  // namespace

std::vector<std::string_view> simd_targets() {
  std::vector<std::string_view> names;
  for (std::uint64_t left = all(); left != 0; left &= left - 1)
    names.push_back(name_of_lowest(left));
  return names;
}

std::string_view simd_target() noexcept { return name_of_lowest(supported()); }

void use_simd_target(std::string_view name) {
  std::string known;
  for (std::uint64_t left = all(); left != 0; left &= left - 1) {
    const std::string_view target = name_of_lowest(left);
    if (target == name) return choose(left & -left);
    known += known.empty() ? "" : ", ";
    known += target;
  }
  throw Error("there is no SIMD target '" + std::string(name) + "' on this processor; it has " +
              known);
}

}  // namespace keepout
