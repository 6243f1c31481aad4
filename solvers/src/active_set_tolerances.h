// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

/// All tolerances of the active-set solver. They are relative to the norm of a row and to the
/// reach. The reach is the larger of |u| and |d| / |J|, the desired motion, which gives a scale if
/// u is 0. So scaling a problem scales its answer and changes no decision.
namespace keepout::active_set {

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// A row that is violated by less counts as satisfied. The slack of a row is known to a few
/// epsilon; a vertex of moderately slanted planes multiplies that by some tens.
inline constexpr double feasibility = 1e-13;

/// A row depends on the active rows if its part outside their span is shorter than this. That part
/// is known to a few epsilon. Rows at a larger angle, even 1e-12, are independent.
inline constexpr double dependence = 64 * epsilon;

/// If the rest of a row after projection is below this fraction of its length, cancellation has
/// cost digits. The projection is then repeated on the rest ("twice is enough").
inline constexpr double cancellation = 1e-2;

/// "Infeasible" means that no u within this many reaches satisfies all rows. Planes that are almost
/// parallel do meet somewhere, but farther out than the precision of their numbers allows to
/// compute.
inline constexpr double horizon = 1e3;

/// Corrections stop here, at the rounding of the residual itself.
inline constexpr double rounding = 8 * epsilon;

/// If equalities and gradient are worse than this after all corrections, the active rows are almost
/// dependent, and there is no answer.
inline constexpr double acceptable = 1e-11;

/// Above this condition number of [J; sqrt(damping) I] the last digits of J decide the answer.
inline constexpr double singular = 1e13;

/// If some direction has less than this fraction of a Jacobian's norm, planes are not scanned at
/// the tip: rounding there would matter for the joints.
inline constexpr double uneven = 1.0 / 16;

/// The range of numbers: squares of products must stay in the range of a double. Larger numbers are
/// rejected, and so are rows that are shorter without being zero. Lengths whose square underflows
/// count as zero.
inline constexpr double largest = 1e70;
inline constexpr double smallest = 1e-70;

}  // namespace keepout::active_set
