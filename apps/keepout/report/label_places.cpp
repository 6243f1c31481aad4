// SPDX-License-Identifier: BSD-3-Clause
#include "report/label_places.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace keepout::app {

std::vector<double> label_places(const std::vector<double>& wanted, double gap, double low,
                                 double high) {
  const std::size_t count = wanted.size();
  if (count == 0) return {};
  if (count > 1) gap = std::min(gap, (high - low) / static_cast<double>(count - 1));
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return wanted[a] < wanted[b]; });

  // With k gaps taken off the k-th, the heights need only not to decrease: an isotonic regression,
  // which pools neighbours that are in the wrong order into their mean.
  struct Pool {
    double sum;
    std::size_t members;
    double mean() const { return sum / static_cast<double>(members); }
  };
  std::vector<Pool> pools;
  for (std::size_t k = 0; k < count; ++k) {
    pools.push_back({wanted[order[k]] - gap * static_cast<double>(k), 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
      const Pool last = pools.back();
      pools.pop_back();
      pools.back().sum += last.sum;
      pools.back().members += last.members;
    }
  }
  std::vector<double> places(count);
  const double lowest_start = high - gap * static_cast<double>(count - 1);
  std::size_t k = 0;
  for (const Pool& pool : pools) {
    const double start = std::max(low, std::min(pool.mean(), lowest_start));
    for (std::size_t i = 0; i < pool.members; ++i, ++k) {
      places[order[k]] = start + gap * static_cast<double>(k);
    }
  }
  return places;
}

}  // namespace keepout::app
