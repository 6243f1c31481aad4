// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/energy_account.h"

#include <algorithm>

namespace keepout {

void EnergyAccount::book(const HeldForce& held, const Vec3& hand_way, const Vec3& proxy_way,
                         double stored) noexcept {
  const double braked = -held.brake.dot(hand_way);
  report_.to_hand += held.total().dot(hand_way);
  report_.from_proxy += held.spring.dot(proxy_way);
  report_.dissipated += held.spring.dot(proxy_way - hand_way) - (stored - report_.stored) + braked;
  report_.braked += braked;
  report_.stored = stored;
  ++report_.cycles;
}

void EnergyAccount::book_blind(double stored) noexcept {
  report_.dissipated -= stored - report_.stored;
  report_.stored = stored;
  ++report_.cycles;
  ++report_.blind_cycles;
}

void EnergyAccount::note_active(double energy) noexcept {
  report_.active = std::max(report_.active, energy);
}

void EnergyAccount::note_force(double newtons) noexcept {
  report_.largest_force = std::max(report_.largest_force, newtons);
}

}  // namespace keepout
