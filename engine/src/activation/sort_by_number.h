// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace keepout {

/// A number to sort by, and what goes with it.
struct Numbered {
  std::uint32_t number;
  std::uint32_t what;
};

/// Sorts by number, all of which differ. Radix sort, from the last digit to the first, of no more
/// digits than the numbers differ in: its work depends on how many there are, not on what they are.
/// `items` and `scratch` are as long as each other; either may hold the result, which is returned.
inline std::span<const Numbered> sort_by_number(std::span<Numbered> items,
                                                std::span<Numbered> scratch) noexcept {
  constexpr std::size_t few = 24;  // cheaper by insertion
  if (items.size() <= few) {
    for (std::size_t i = 1; i < items.size(); ++i) {
      const Numbered item = items[i];
      std::size_t place = i;
      for (; place > 0 && items[place - 1].number > item.number; --place) {
        items[place] = items[place - 1];
      }
      items[place] = item;
    }
    return items;
  }

  std::uint32_t least = items[0].number;
  std::uint32_t most = least;
  for (const Numbered& item : items) {
    least = std::min(least, item.number);
    most = std::max(most, item.number);
  }
  constexpr int digit_bits = 8;
  constexpr std::uint32_t digits = 1u << digit_bits;
  const int bits = std::bit_width(most - least);
  for (int shift = 0; shift < bits; shift += digit_bits) {
    const auto digit = [&](const Numbered& item) {
      return ((item.number - least) >> shift) % digits;
    };
    std::array<std::uint32_t, digits> place{};
    for (const Numbered& item : items) ++place[digit(item)];
    std::uint32_t before = 0;
    for (std::uint32_t& p : place) before += std::exchange(p, before);
    for (const Numbered& item : items) scratch[place[digit(item)]++] = item;
    std::swap(items, scratch);
  }
  return items;
}

}  // namespace keepout
