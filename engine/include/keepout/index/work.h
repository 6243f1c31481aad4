// SPDX-License-Identifier: BSD-3-Clause
//
// The weights of all work that a control cycle counts, for tips and instruments: see Budget.
#pragma once

#include <cstddef>

namespace keepout::work {

// A work unit takes about 30 ns: the median of instruments' cycles on an AMD EPYC, on AVX2 and
// AVX-512. The weights of the certified rule and of instruments are from least squares over
// recorded cycles, near earlier estimates. Those of hulls, guides and queries are estimates. A
// candidate has the weight of empty caches, because the budget must bound the worst cycle.

// Traversals of an index along a motion.
inline constexpr std::size_t boxes = 1;       // sixteen boxes in single precision
inline constexpr std::size_t cylinders = 3;   // sixteen cylinders
inline constexpr std::size_t leaf = 4;        // reads sixteen triangles, and prepares their filter
inline constexpr std::size_t suspects = 1;    // a filter of sixteen triangles, for a motion
inline constexpr std::size_t sharpening = 6;  // the more accurate filter

// Searches for the nearest triangle, and queries.
inline constexpr std::size_t nearest_box = 4;       // a node or a leaf; mostly cache misses
inline constexpr std::size_t nearest_decision = 5;  // a triangle in double
inline constexpr std::size_t nearest_in_order = 1;  // the same without cache misses
inline constexpr std::size_t hit = 10;  // finds and measures a candidate; mostly cache misses

// The certified rule.
inline constexpr std::size_t coverage = 1;  // a triangle against up to sixteen planes
inline constexpr std::size_t triangle = 3;  // prepares a triangle in double
inline constexpr std::size_t contact = 5;   // its first contact, and the proof that it stays clear
inline constexpr std::size_t wall = 1;      // eight prepared triangles against the walls
inline constexpr std::size_t plane = 4;     // rotates a plane
inline constexpr std::size_t scan = 1;      // 64 entries of a list

// The free polytope.
inline constexpr std::size_t polytope_hit = 8;     // reads the corners of a triangle, and sorts it
inline constexpr std::size_t polytope_plane = 40;  // finds a plane
inline constexpr std::size_t polytope_test = 2;    // a triangle against a plane

// Convex tools.
inline constexpr std::size_t tool_direction = 1;   // up to sixteen points along a direction
inline constexpr std::size_t tool_separation = 4;  // from a triangle, and ...
inline constexpr std::size_t tool_point = 1;       // ... for each point of the tool
inline constexpr std::size_t tool_suspect = 3;     // sorts a triangle, for a trial

// Quadratic programs: see Budget::spend_solve.
inline constexpr std::size_t solve = 6;
inline constexpr std::size_t factor = 5;  // 64 operations
inline constexpr std::size_t iteration = 5;
inline constexpr std::size_t solved_rows = 1;  // 48 numbers of the rows, in an iteration

// The step of an instrument.
inline constexpr std::size_t cycle = 8;         // what each cycle does once
inline constexpr std::size_t pair = 2;          // a body beside a mesh, when it is opened or judged
inline constexpr std::size_t kinematics = 11;   // places the chain
inline constexpr std::size_t four_points = 2;   // their bounds for a motion
inline constexpr std::size_t search = 6;        // for the triangles near a body
inline constexpr std::size_t collected = 1;     // eight triangles that the index returns
inline constexpr std::size_t candidate = 6;     // reads one of them: cold 220 ns, warm 25 ns
inline constexpr std::size_t screened = 1;      // sixteen triangles in single precision
inline constexpr std::size_t listed = 2;        // a triangle that is listed and sorted
inline constexpr std::size_t listed_again = 1;  // sixteen listed triangles, passed over
inline constexpr std::size_t judged = 1;        // a triangle against the planes of its body
inline constexpr std::size_t gap_of_capsule = 6;
inline constexpr std::size_t gap_of_hull = 12;
inline constexpr std::size_t separation = 1;  // by a plane, for a part of a motion
inline constexpr std::size_t row = 10;        // of a contact

/// Returns the units of the gap between a triangle and the core of a body with `points` points.
constexpr std::size_t gap(std::size_t points) noexcept {
  return points > 2 ? gap_of_hull : gap_of_capsule;
}

// Guides of tips and instruments.
inline constexpr std::size_t guide = 2;  // a region at a point of the motion

}  // namespace keepout::work
