// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "record/record.h"

namespace CLI {
class App;
}

namespace keepout::app {

/// The planners that can be asked for; all with the same settings under each checker.
inline const std::vector<std::string> ompl_planners{"RRTConnect", "RRT", "PRM", "BITstar"};

struct PlanOptions {
  std::vector<std::filesystem::path> meshes;  // one; empty: airway and skull, of the real fixtures
  bool inside = false;                        // plan within the mesh given, not around it
  std::string
      robot;  // of robots_under_test(): plan for all of it, in joint space; empty: for a tip
  std::size_t problems = 12;  // for each mesh
  std::size_t seeds = 10;     // with a robot: runs of each problem under each checker
  std::uint64_t seed = 1;
  std::string planner = "RRTConnect";
  double seconds = 5.0;                                  // that a planner has for a problem
  std::vector<double> resolutions{0.01, 0.001, 0.0001};  // of sampled checking [1 / extent]
  double tool_radius = 0.3;                              // [mm]
  double margin = 0.2;                                   // [mm]
  double radius = 5.0;                                   // of the motion sphere [mm]
  double range = 0.0;     // of the planner [mm]; 0: a fifth of the extent, as OMPL has it
  bool simplify = false;  // shorten each path by OMPL's simplifier, under the same checker
  RecordFiles files;
  std::string command;  // that does it again

  double clearance() const noexcept { return tool_radius + margin; }
  /// Runs of each problem under each checker.
  std::size_t repetitions() const noexcept { return robot.empty() ? 1 : seeds; }
};

/// Adds `keepout plan` and its options to the command line.
void add_plan(CLI::App& app, PlanOptions& options);

/// Plans under several checkers side by side and has an independent oracle judge the paths. The
/// exit status: success only if all paths that keepout let pass are valid. Throws Error where
/// keepout was built without OMPL.
int plan(const PlanOptions& options, std::ostream& out);

}  // namespace keepout::app
