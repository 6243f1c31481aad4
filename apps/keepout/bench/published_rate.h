// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

namespace keepout::app {

/// Rates of the whole control step that Li et al. 2020 give in words for the Stanford bunny
/// (section on run time). They ran on an Intel Core i7-8700; the radius is not given.
struct PublishedRate {
  std::size_t triangles;
  std::size_t vertices;
  double khz;
};
inline constexpr std::array<PublishedRate, 2> published_rates = {
    {{51978, 25991, 7.73}, {989376, 493460, 0.180}}};

}  // namespace keepout::app
