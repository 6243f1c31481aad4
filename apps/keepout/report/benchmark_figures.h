// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/benchmark_rows.h"

namespace keepout::app {

/// The pictures of a benchmark, each as an <svg> element. Names keep their colour and their mark in
/// all of them: those of their place in `all`.

/// Time of a query, or of its candidates alone, against the size of the mesh, a line for each
/// index. Precondition, as below: the rows are those of one radius, and the stage was timed.
std::string query_plot(const Rows& rows, Stage stage, const std::vector<std::string>& all);

/// The same on one mesh: an axis of time, a line of writing for each index.
std::string query_spans(const Rows& rows, const std::vector<std::string>& all);

/// Rate of the whole step against the size of the mesh, a line for each of the combinations, and
/// the rates that the paper published.
enum class Over { triangles, vertices };
std::string rate_plot(const std::vector<Rows>& combinations, Over over);

/// The same where each was timed on one mesh alone: an axis of rate, a line of writing for each.
std::string rate_spans(const std::vector<Rows>& combinations);

/// Time of the solver against the planes that it was given. Empty where no row has that percentile.
enum class Percentile { median, p99 };
std::string solve_plot(const Rows& rows, const std::vector<std::string>& all, Percentile told);

/// What the median steps are made of: no query, where the rule searches the index by itself.
/// Precondition: all other stages were timed.
std::string stage_bars(const Rows& rows);

/// What an index costs before the first query. One row an index.
std::string build_bars(Rows rows);
std::string memory_bars(Rows rows);

/// "wide_bvh, paper, active_set, r = 5 mm"
std::string line_name(const BenchmarkRow& row);

}  // namespace keepout::app
