// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

namespace keepout {

/// A spring and a damper between the hand and its proxy, along the line between them. The force
/// points from the hand to the proxy or is zero: it never sucks the hand towards the surface.
///
/// A display that is updated every T seconds is passive if its own damping b is at least
/// stiffness T / 2 + damping (Colgate and Schenkel 1994): a stiff spring needs a fast loop.
struct SpringDamper {
  double stiffness = 1.0;      // [N / length], > 0
  double damping = 0.0;        // [N s / length], >= 0
  double largest_force = 4.0;  // the force saturates there [N], > 0
  double largest_rise = std::numeric_limits<double>::infinity();  // of the force [N / s], > 0

  /// The spring's part at a stretch: stiffness times it, up to the largest force. [N]
  double spring_force(double stretch) const noexcept;

  /// Spring and damper: not below 0, nor above the largest force. `rate`: of the stretch.
  /// [length / s]
  double force(double stretch, double rate) const noexcept;

  /// What the spring holds at a stretch: the integral of spring_force. [N length]
  double stored(double stretch) const noexcept;
};

/// Throws Error when a number is out of range, naming it.
void check(const SpringDamper& spring);

}  // namespace keepout
