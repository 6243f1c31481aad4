// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/benchmark.h"

namespace keepout::app {

/// Which rows of a benchmark go together in one picture or one sentence.

using Rows = std::vector<const BenchmarkRow*>;  // in their order; they outlive this
using Stage = std::optional<Timing> BenchmarkRow::*;

/// Those in which the stage was timed.
Rows timed(const Benchmark& benchmark, Stage stage);

/// Whether all steps but one in a hundred at most have an answer: a solver that gives up may be
/// quick, but is not fast.
bool answers(const BenchmarkRow& row);

/// Whether at least half of the queries find a triangle: else their median is the time of finding
/// nothing, and there is nothing to keep a step from.
bool reaches(const BenchmarkRow& row);

/// Those that may be set against each other by their median time of a stage: there are triangles in
/// reach, the steps have answers, and the clock saw the stage take time. Precondition: the stage
/// was timed in all.
Rows ranked(const Rows& rows, Stage stage);

Rows only(const Rows& rows, const std::function<bool(const BenchmarkRow&)>& wanted);

/// Median of a stage that was timed. [us]
double median(const BenchmarkRow& row, Stage stage);

/// Precondition: there is one, and the stage was timed in all. The first of equals.
const BenchmarkRow& fastest(const Rows& rows, Stage stage);
const BenchmarkRow& slowest(const Rows& rows, Stage stage);

/// Without doubles, in the order in which they appear.
std::vector<std::string> names(const Rows& rows, std::string BenchmarkRow::*part);
std::vector<std::size_t> sizes(const Rows& rows);  // in triangles, ascending

/// Radii of the motion sphere, the largest first, "as far as motions lead" last.
std::vector<std::optional<double>> radii(const Rows& rows);
Rows at_radius(const Rows& rows, const std::optional<double>& radius);

/// Those on a mesh of that name, in whatever size.
Rows on_mesh(const Rows& rows, const std::string& mesh);

/// Those on one mesh: the one on which there are most, and of these the largest.
Rows on_common_mesh(const Rows& rows);

/// One row for each index and mesh, all of the rule that most of them share, and as far as there
/// are any of the solver too: what differs is the index alone. Of a solver that answers, wherever
/// there is one.
Rows comparable_indices(const Rows& rows);

/// Those of one rule: the one under which most solvers were timed.
Rows comparable_solvers(const Rows& rows);

/// The solver's row that stands for each mesh, size and radius, of those that differ in the index:
/// the one of median time. Precondition: the search for the motion was timed in all.
Rows problems_of(const Rows& rows, const std::string& solver);

/// The combinations whose rate over the size of the mesh is worth a line, one each: under every
/// rule ours and its peer's, or else the fastest and the slowest there are on the mesh that most
/// have; each with the largest sphere, and the smallest mesh first. `rows`: those on one mesh.
std::vector<Rows> rate_lines(const Rows& rows);

/// How often the median step fits into a second. [kHz]
double rate_khz(const BenchmarkRow& row);

/// Where a rate line passes 1 kHz, by a straight line between its points in the plot.
struct RateCrossing {
  const BenchmarkRow* before;
  const BenchmarkRow* after;
  double triangles;
};
std::vector<RateCrossing> crossings_of_1_khz(const Rows& line);

/// "wide_bvh, paper, active_set"
std::string combination(const BenchmarkRow& row);

/// "5 mm"; "as far as the motion leads".
std::string radius_text(const std::optional<double>& radius);

/// "with a motion sphere of 5 mm"; "looking as far as the motion leads".
std::string sphere_text(const std::optional<double>& radius);

/// "bunny with 985,856 triangles"
std::string mesh_text(const BenchmarkRow& row);

/// A pair of an index and a solver that we set side by side wherever both were timed.
struct Pair {
  const char* index;
  const char* solver;
};
inline constexpr Pair our_pair = {"wide_bvh", "active_set"};
inline constexpr Pair peer_pair = {"fcl_obbrss", "nlopt_slsqp"};
bool is(const BenchmarkRow& row, const Pair& pair);

}  // namespace keepout::app
