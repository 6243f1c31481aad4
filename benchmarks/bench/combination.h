// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace keepout::app {

/// One way to put a step together.
struct Combination {
  std::string index, activation, solver;
  std::optional<double> radius;  // of the motion sphere [mm]; none: as far as motions lead

  bool operator==(const Combination&) const = default;
};

/// What the user asked for; empty lists are up to us.
struct Selection {
  std::vector<std::string> indices = {}, activations = {}, solvers = {};
  std::vector<double> radii = {};  // [mm]
};

/// Whether any part was asked for by name.
bool names_parts(const Selection& selection);

/// Every combination of what was asked for, and where nothing was, of the reference: wide_bvh, the
/// rules paper and certified, active_set. If no part was asked for at all: each index with the
/// reference, each rule and solver with the reference, and what a user of the usual libraries would
/// put together, FCL's tree with SLSQP.
///
/// The certified rule looks as far as the motion leads whatever the radius: it is listed once.
/// Only parts that this build has; sorted by index, so that each is built once.
std::vector<Combination> combinations_of(const Selection& selection);

}  // namespace keepout::app
