// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/time_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace keepout::app {
namespace {

constexpr unsigned bits_of_a_bin = std::bit_width(TimeHistogram::bins_of_a_doubling) - 1;

}  // namespace

std::size_t TimeHistogram::bin_of(std::uint64_t ns) noexcept {
  if (ns < 1) return 0;
  const unsigned doubling = static_cast<unsigned>(std::bit_width(ns)) - 1;
  // The three bits after the first: bins of equal width within a doubling.
  const std::uint64_t place = doubling >= bits_of_a_bin ? ns >> (doubling - bits_of_a_bin)
                                                        : ns << (bits_of_a_bin - doubling);
  return std::min<std::size_t>(doubling * bins_of_a_doubling + (place - bins_of_a_doubling),
                               bins - 1);
}

double TimeHistogram::beginning_of(std::size_t bin) noexcept {
  const auto doubling = static_cast<int>(bin / bins_of_a_doubling);
  const auto place = static_cast<double>(bin % bins_of_a_doubling);
  return std::ldexp(1.0 + place / bins_of_a_doubling, doubling);
}

void TimeHistogram::add(std::uint64_t ns) noexcept {
  ++counts_[bin_of(ns)];
  ++total_;
  longest_ = std::max(longest_, ns);
}

std::optional<double> TimeHistogram::percentile(double share) const noexcept {
  if (total_ == 0) return std::nullopt;
  const auto rank = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(total_)));
  std::uint64_t passed = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    passed += counts_[bin];
    if (passed >= rank && passed > 0) return beginning_of(bin + 1);
  }
  return beginning_of(bins);
}

}  // namespace keepout::app
