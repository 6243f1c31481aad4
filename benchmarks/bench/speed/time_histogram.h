// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace keepout::app {

/// Counts times in memory of a fixed size: 1 ns to 4 s, each doubling in eight bins of equal width,
/// so that a bin tells a time to an eighth.
///
/// Source: G. Tene, HdrHistogram, of the layout of bins.
class TimeHistogram {
 public:
  static constexpr unsigned bins_of_a_doubling = 8;
  static constexpr std::size_t bins = 32 * bins_of_a_doubling;

  /// What lies outside is counted in the first or the last bin. [ns]
  void add(std::uint64_t ns) noexcept;

  std::uint64_t count(std::size_t bin) const noexcept { return counts_[bin]; }
  std::uint64_t total() const noexcept { return total_; }
  std::uint64_t longest() const noexcept { return longest_; }  // [ns]

  /// Where a bin begins; it ends where the next begins. [ns]
  static double beginning_of(std::size_t bin) noexcept;
  static std::size_t bin_of(std::uint64_t ns) noexcept;

  /// The end of the bin that the share of all times reaches, 0.999 of them for one; none, if
  /// nothing was added. [ns]
  std::optional<double> percentile(double share) const noexcept;

 private:
  std::array<std::uint64_t, bins> counts_{};
  std::uint64_t total_ = 0;
  std::uint64_t longest_ = 0;
};

}  // namespace keepout::app
