// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/unit_guess.h"

#include <array>

namespace keepout {
namespace {

// Of organs and bones. [mm]
constexpr double smallest = 20.0;
constexpr double largest = 600.0;
// From here up to what no anatomy exceeds, millimetres are not in doubt. [mm]
constexpr double usual = 30.0;
constexpr double too_large = 3000.0;

constexpr std::array<UnitGuess, 4> units{
    {{"m", 1000.0}, {"in", 25.4}, {"cm", 10.0}, {"um", 0.001}}};

}  // namespace

std::vector<UnitGuess> other_units(double extent) {
  std::vector<UnitGuess> guesses;
  if (extent >= usual && extent <= too_large) return guesses;
  for (const UnitGuess& guess : units) {
    const double size = extent * guess.millimetres;
    if (size >= smallest && size <= largest) guesses.push_back(guess);
  }
  return guesses;
}

}  // namespace keepout
