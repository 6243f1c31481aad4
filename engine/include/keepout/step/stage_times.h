// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace keepout {

/// The time that each part of a step took, to know them apart. What a failed step does not reach
/// stays at zero. [ns]
struct StageTimes {
  std::int64_t query = 0;       // the index is asked what is around; of a walk, its beginning
  std::int64_t activation = 0;  // the rule begins
  std::int64_t solve = 0;       // trials are solved and judged

  /// Of all stages. [ns]
  std::int64_t total() const noexcept { return query + activation + solve; }
};

}  // namespace keepout
