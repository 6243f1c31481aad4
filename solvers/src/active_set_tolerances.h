// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

/// Every tolerance of the active-set solver. All are relative: to the norm of a row, and to the
/// reach, the larger of |u| and |d| / |J| (the motion asked for, which keeps a scale when u is 0).
/// Scaling a problem therefore scales its answer and changes no decision.
namespace keepout::active_set {

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// A row violated by less counts as satisfied. The slack of a row is known to a few epsilon; a
/// vertex of moderately slanted planes multiplies that by some tens.
inline constexpr double feasibility = 1e-13;

/// A row whose part outside the span of the active rows is shorter than this depends on them.
/// That part is known to a few epsilon; rows at a larger angle, even 1e-12, are told apart.
inline constexpr double dependence = 64 * epsilon;

/// Below this share of its length what is left of a row after projection has lost digits to
/// cancellation, and the projection is repeated on the remainder ("twice is enough").
inline constexpr double cancellation = 1e-2;

/// "Infeasible" promises that no u within this many reaches satisfies all rows. Planes that are
/// parallel to the last bit but one do meet somewhere, farther out than their numbers tell.
inline constexpr double horizon = 1e3;

/// Corrections stop here: what is left is the rounding of the residual itself.
inline constexpr double rounding = 8 * epsilon;

/// Equalities and gradient worse than this after all corrections: the active rows are too close
/// to dependent to solve with, and the answer is withheld.
inline constexpr double acceptable = 1e-11;

/// Beyond this condition number of [J; sqrt(damping) I] the last digits of J decide the answer.
inline constexpr double singular = 1e13;

/// A Jacobian that gives some direction less than this share of its norm does not serve to look
/// through planes at the tip: rounding there would count for the joints.
inline constexpr double uneven = 1.0 / 16;

/// The range of numbers: squares of products must stay in the range of a double. Larger ones, and
/// rows that are shorter without being zero, are refused; lengths so small that their square
/// vanishes count as zero.
inline constexpr double largest = 1e70;
inline constexpr double smallest = 1e-70;

}  // namespace keepout::active_set
