// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "operators/strokes.h"
#include "shared/columns.h"
#include "simulate/simulate.h"
#include "simulate/tally.h"

namespace keepout::app {

/// A stroke, and its cycles under each guard.
struct FollowedStroke {
  Stroke stroke;
  std::vector<std::vector<Cycle>> runs = {};
};

/// The outcome of a simulation, for a record and a terminal.
struct SimulationResult {
  Json record;                // see docs/records.md
  Columns<RunTally> columns;  // the columns of the table of all runs
  std::string_view legend = {};
  bool is_broken = false;    // a guarantee was broken
  bool is_untested = false;  // no guarded tool moved, or none was inside a guide
};

/// The tool that an operator moves over meshes in the closed loop of simulate(), under each of its
/// guards.
class SimulatedTool {
 public:
  virtual ~SimulatedTool() = default;

  /// Loads the next mesh. Returns null if a signal comes meanwhile. Throws Error.
  virtual std::shared_ptr<const Mesh> open(const std::filesystem::path& mesh,
                                           const StopSignal& stop) = 0;
  /// Returns the names of the guards; "none" lets the tool go anywhere.
  virtual std::vector<std::string> guards() const = 0;
  /// Draws the next stroke. Throws Error if no place is suitable.
  virtual Stroke draw(std::uint64_t number, double speed) = 0;

  /// Places the tool at the start of a stroke, under a guard.
  virtual StrokeStart start(const Stroke& stroke, std::size_t guard) = 0;
  /// Runs one cycle: steps towards the goal, applies the motion and judges it.
  virtual Cycle follow(const Pose& goal) = 0;

  /// Keeps the data of a stroke for the record.
  virtual void keep(FollowedStroke followed) = 0;
  /// Returns the result of the runs, one for each mesh, speed and guard.
  virtual SimulationResult result(const std::vector<RunTally>& runs) = 0;
};

/// Returns a tip, unguarded and under each rule. Throws Error for contradictory options. The
/// options must outlive it.
std::unique_ptr<SimulatedTool> make_guarded_tip(const SimulateOptions& options);

/// Returns the instrument of a robot, in joint space: with the certified step, with a step that
/// certifies a linearized motion, with a certified tip only, and without a guard. The options must
/// outlive it.
std::unique_ptr<SimulatedTool> make_guarded_instrument(const SimulateOptions& options);

}  // namespace keepout::app
