// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "../../parallel.h"
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

/// Calls work(part, begin, end) for `threads` ranges of equal size that together are 0 to `size`,
/// at the same time.
template <class Work>
void share_equally(std::size_t size, unsigned threads, const Work& work) {
  if (threads <= 1) return work(std::size_t{0}, std::size_t{0}, size);
  const std::size_t share = (size + threads - 1) / threads;
  share_ranges(size, threads, share,
               [&](std::size_t begin, std::size_t end) { work(begin / share, begin, end); });
}

/// Moves the centers to `to`, the `middle` ones with the smallest keys to its front. The number of
/// the triangle decides ties, so each half depends only on the mesh. The order within a half does
/// not depend on the number of threads.
///
/// A histogram of the keys, which are in low .. high, gives the bin of the middle. One pass moves
/// the centers of the other bins to their half, without branches that a processor cannot predict.
template <class Key>
void split_at(std::span<const Center> from, std::span<Center> to, std::size_t middle, float low,
              float high, unsigned threads, const Key& key) {
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
  const auto bins_of = [key, low, scale, last_bin](const Center& center) {
    return std::min(static_cast<std::int32_t>((key(center) - low) * scale), last_bin);
  };
  using Counts = std::array<std::uint32_t, most_bins>;
  Counts counts;  // of the centers in each bin
  std::vector<Counts> shared(threads > 1 ? threads : 0);
  std::fill_n(counts.begin(), bins, 0u);
  share_equally(from.size(), threads, [&](std::size_t part, std::size_t begin, std::size_t end) {
    Counts& of_part = shared.empty() ? counts : shared[part];
    const auto bin_of = bins_of;  // a copy, which stores cannot change: it stays in registers
    for (const Center& center : from.subspan(begin, end - begin)) {
      ++of_part[static_cast<std::size_t>(bin_of(center))];
    }
  });
  for (const Counts& of_part : shared) {
    for (std::size_t bin = 0; bin < bins; ++bin) counts[bin] += of_part[bin];
  }
  std::int32_t its_bin = 0;  // the bin of the middle
  std::size_t before = 0;
  while (before + counts[static_cast<std::size_t>(its_bin)] <= middle) {
    before += counts[static_cast<std::size_t>(its_bin++)];
  }

  // A part's centers come after those of the parts before it.
  struct Ends {
    Center *left, *here, *right;
  };
  const std::size_t in_split_bin = counts[static_cast<std::size_t>(its_bin)];
  const Ends first{to.data(), to.data() + before, to.data() + before + in_split_bin};
  std::vector<Ends> ends(shared.size(), first);
  for (std::size_t part = 1; part < shared.size(); ++part) {
    const Counts& previous = shared[part - 1];
    const auto split = previous.begin() + its_bin;
    ends[part].left = ends[part - 1].left + std::accumulate(previous.begin(), split, 0u);
    ends[part].here = ends[part - 1].here + *split;
    ends[part].right = ends[part - 1].right + std::accumulate(split + 1, previous.end(), 0u);
  }
  share_equally(from.size(), threads, [&](std::size_t part, std::size_t begin, std::size_t end) {
    auto [left, here, right] = ends.empty() ? first : ends[part];
    const auto bin_of = bins_of;
    const std::int32_t split_bin = its_bin;
    for (const Center& center : from.subspan(begin, end - begin)) {
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
  });
  settle(to.subspan(before, in_split_bin), middle - before);
}

}  // namespace keepout
