// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "block_memory.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// The position of a triangle, for building a tree. It affects the speed of the tree, and never its
/// answers.
struct Center {
  std::array<float, 3> position;  // from the middle of the mesh's bounds [length]
  TriangleId triangle;
};

/// Returns the middle of each triangle's bounds, in the order of the triangles.
BlockVector<Center> centers_of(const Mesh& mesh, unsigned threads);

/// The mean of the triangles' centers, relative to the middle of the mesh, and their spread.
struct Spread {
  Vec3 mean;                   // [length]
  Eigen::Matrix3d covariance;  // times the number of triangles [length^2]
};

/// Returns the spread of at least one triangle, in one pass. Coordinates are relative to the first
/// triangle, so the final subtraction loses few digits.
Spread spread_of(std::span<const Center> centers) noexcept;

/// Returns orthonormal rows, the direction of the largest spread first. The eigenvectors only
/// choose the frame. The cross products make it orthonormal up to rounding, which the box tests
/// need.
Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& covariance) noexcept;

/// Moves the centers to `to`, the `middle` ones with the smallest keys to its front. The number of
/// the triangle decides ties, so each half depends only on the mesh.
///
/// A histogram of the keys, which are in low .. high, gives the bin of the middle. One pass moves
/// the centers of the other bins to their half, without branches that a processor cannot predict.
template <class Key>
void split_at(std::span<const Center> from, std::span<Center> to, std::size_t middle, float low,
              float high, const Key& key) noexcept {
  constexpr std::size_t most_bins = 1024;
  const std::size_t bins = std::clamp(from.size(), std::size_t{16}, most_bins);
  const auto settle = [&](std::span<Center> part, std::size_t rank) {
    std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(rank), part.end(),
                     [&](const Center& a, const Center& b) {
                       const float at_a = key(a);
                       const float at_b = key(b);
                       return at_a != at_b ? at_a < at_b : a.triangle < b.triangle;
                     });
  };
  const float scale = static_cast<float>(bins) / (high - low);
  if (!(std::isfinite(scale) && scale > 0.0f)) {
    std::copy(from.begin(), from.end(), to.begin());
    settle(to, middle);
    return;
  }
  const auto last_bin = static_cast<std::int32_t>(bins) - 1;
  const auto bin_of = [&](const Center& center) {
    return std::min(static_cast<std::int32_t>((key(center) - low) * scale), last_bin);
  };
  std::array<std::uint32_t, most_bins> counts;
  std::fill_n(counts.begin(), bins, 0u);
  for (const Center& center : from) ++counts[static_cast<std::size_t>(bin_of(center))];
  std::int32_t split_bin = 0;
  std::size_t before = 0;
  while (before + counts[static_cast<std::size_t>(split_bin)] <= middle) {
    before += counts[static_cast<std::size_t>(split_bin++)];
  }

  Center* left = to.data();
  Center* here = to.data() + before;
  Center* right = here + counts[static_cast<std::size_t>(split_bin)];
  for (const Center& center : from) {
    const std::int32_t bin = bin_of(center);
    if (bin == split_bin) [[unlikely]] {
      *here++ = center;
      continue;
    }
    const bool is_left = bin < split_bin;
    *(is_left ? left : right) = center;
    left += is_left;
    right += !is_left;
  }
  settle(to.subspan(before, counts[static_cast<std::size_t>(split_bin)]), middle - before);
}

}  // namespace keepout
