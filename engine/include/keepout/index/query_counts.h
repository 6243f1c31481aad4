// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace keepout {

/// What a query of ours had to look at. Unlike its time it is the same on every run, so that a
/// tree that got worse shows.
struct QueryCounts {
  std::size_t nodes = 0;      // looked at, each with all its boxes
  std::size_t blocks = 0;     // leaf blocks whose triangles were compared with the ball
  std::size_t triangles = 0;  // of which floats were not sure: the exact kernel was asked
};

}  // namespace keepout
