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

/// The available planners; all have the same settings under each checker.
inline const std::vector<std::string> ompl_planners{"RRTConnect", "RRT", "PRM", "BITstar"};

struct PlanOptions {
  std::vector<std::filesystem::path> meshes;  // at most one; empty: the sample meshes airway and
                                              // skull
  bool inside = false;                        // plan within the given mesh, not around it
  std::string robot;             // see chosen_robot, for a plan in joint space; empty: for a tip
  std::filesystem::path bodies;  // of the robot of a URDF file
  std::size_t problems = 12;     // for each mesh
  std::size_t seeds = 10;        // with a robot: runs of each problem under each checker
  std::uint64_t seed = 1;
  std::string planner = "RRTConnect";
  double seconds = 5.0;                                  // of a planner for a problem
  std::vector<double> resolutions{0.01, 0.001, 0.0001};  // of sampled checking [1 / extent]
  double tool_radius = 0.3;                              // [mm]
  double margin = 0.2;                                   // [mm]
  double radius = 5.0;                                   // of the motion sphere [mm]
  double range = 0.0;     // of the planner [mm]; 0: a fifth of the extent, OMPL's default
  bool simplify = false;  // shorten each path by OMPL's simplifier, under the same checker
  RecordFiles files;
  std::string command;  // the command line that repeats it

  double clearance() const noexcept { return tool_radius + margin; }
  /// Returns the number of runs of each problem under each checker.
  std::size_t repetitions() const noexcept { return robot.empty() ? 1 : seeds; }
};

/// Adds `keepout plan` and its options to the command line.
void add_plan(CLI::App& app, PlanOptions& options);

/// Plans under several checkers side by side; an independent oracle judges the paths. Returns the
/// exit status: success only if all paths that keepout accepted are valid. Throws Error if keepout
/// was built without OMPL.
int plan(const PlanOptions& options, std::ostream& out);

}  // namespace keepout::app
