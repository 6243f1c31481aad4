// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shared/columns.h"
#include "shared/machine.h"
#include "shared/timing.h"

namespace keepout::app {

/// One combination of parts on one mesh.
struct BenchmarkRow {
  std::string mesh = {};
  std::size_t triangles = 0;
  std::size_t vertices = 0;
  double load_s = 0.0;                // from the mesh's file, before it is resampled
  double load_cores = 0.0;            // kept busy meanwhile, in the mean
  std::optional<double> radius = {};  // of the motion sphere [mm]; none: as far as motions lead
  std::string index = {}, activation = {}, solver = {};

  std::size_t queries = 0;  // and steps: of the same motions, the first so many
  double build_s = 0.0;
  double build_cores = 0.0;  // kept busy meanwhile, in the mean
  double bytes_per_triangle = 0.0;
  double candidates_mean = 0.0;  // of the query: that the index proposed
  double hits_mean = 0.0;        // of the query: of them, truly in reach
  double reaching_share = 0.0;   // of the queries: that find a triangle
  double planes_mean = 0.0;      // of the step: that the solver was given in the end
  double unsolved_share = 0.0;   // of the steps: ended in a status that is not ok

  /// Of the steps, with a solver other than the reference's, under a rule that accepts a motion for
  /// its proof alone: right, but farther from what was asked for than the reference's, by more than
  /// a thousandth of it.
  double worse_share = 0.0;

  // The query, apart from the step: the same work for every index.
  std::optional<Timing> collect = {};  // candidates only
  std::optional<Timing> query = {};    // all triangles in the ball, exact, with closest points

  // The step.
  std::optional<Timing> step = {};        // all of it, by itself
  std::optional<Timing> step_query = {};  // none under a rule that searches the index by itself
  std::optional<Timing> activate = {};
  std::optional<Timing> solve = {};

  std::uint64_t hash = 0;                     // of all steps: equal if they are equal, bit for bit
  std::vector<std::uint64_t> first_hashes{};  // of the first 1, 2, 4, 8, ... of them
  bool verified = false;                      // what is not, is not timed
  std::string remark = {};                    // why it was not timed, or is not ranked
};

struct Benchmark {
  std::string date;     // ISO 8601, UTC
  std::string command;  // that does it again
  std::uint64_t seed = 0;
  Machine machine;
  std::map<std::string, std::string> parts = {};    // what each index, rule and solver is
  std::map<std::string, std::string> remarks = {};  // what an index does more or less than others
  std::size_t planned = 0;                          // rows; more than there are: it was stopped
  std::optional<double> others_cores = {};  // that other processes kept busy meanwhile, if known
  std::vector<BenchmarkRow> rows = {};
};

/// What is printed for a terminal: where it ran and what the columns mean; line by line as the rows
/// come in; and, in the end, the headline and how busy other processes kept the machine.
void print_machine(std::ostream& out, const Machine& machine);
void print_table_head(std::ostream& out);
void print_table_row(std::ostream& out, const BenchmarkRow& row);
void print_headline(std::ostream& out, const Benchmark& benchmark);

/// A pair of an index and a solver. The headline compares these two if both were timed.
struct Pair {
  const char* index;
  const char* solver;
};
inline constexpr std::array pairs{Pair{"wide_bvh", "active_set"},
                                  Pair{"fcl_obbrss", "nlopt_slsqp"}};

/// The rows that the headline compares, of those timed without a remark: on the largest mesh, with
/// the largest sphere there, under one rule. Null if there is none.
struct Ranking {
  const BenchmarkRow* fastest = nullptr;
  const BenchmarkRow* slowest = nullptr;
};
Ranking ranking_of(const Benchmark& benchmark);

/// Returns how many groups of rows that differ only in the index made the same steps, as far as
/// their motions are the same, and how many rows are not compared.
Json step_groups_of(const Benchmark& benchmark);

/// Returns a sentence with the times of the fastest and of the slowest row.
std::string headline(const Benchmark& benchmark);

/// The record of it, as docs/records.md describes it.
Json json_of(const Benchmark& benchmark);

/// The rows, one a line, below a line of names; what was not measured is empty. Each says where it
/// was measured, so that files can be put together.
void write_csv(std::ostream& out, const Benchmark& benchmark);

}  // namespace keepout::app
