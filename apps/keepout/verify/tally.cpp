// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tally.h"

#include <algorithm>
#include <numeric>

namespace keepout::app {

std::uint64_t Tally::breach_count() const noexcept {
  return std::accumulate(breaches.begin(), breaches.end(), std::uint64_t{0});
}

void Tally::add(const Verdict& verdict, Status status, double margin) noexcept {
  ++steps;
  ++statuses[static_cast<std::size_t>(status)];
  led_out += verdict.was_led_out ? 1 : 0;
  if (verdict.breach) ++breaches[static_cast<std::size_t>(*verdict.breach)];
  if (verdict.was_led_out || !(verdict.tolerance > 0.0)) return;
  const double beyond = verdict.distance - margin;
  least = std::min(least, beyond);
  least_in_tau = std::min(least_in_tau, beyond / verdict.tolerance);
}

Tally& Tally::operator+=(const Tally& other) noexcept {
  trajectories += other.trajectories;
  steps += other.steps;
  tips += other.tips;
  led_out += other.led_out;
  for (std::size_t i = 0; i < statuses.size(); ++i) statuses[i] += other.statuses[i];
  for (std::size_t i = 0; i < breaches.size(); ++i) breaches[i] += other.breaches[i];
  least = std::min(least, other.least);
  least_in_tau = std::min(least_in_tau, other.least_in_tau);
  seconds += other.seconds;
  return *this;
}

Tally Findings::total() const noexcept {
  Tally sum;
  for (const SceneResult& scene : scenes) sum += scene.tally;
  return sum;
}

}  // namespace keepout::app
