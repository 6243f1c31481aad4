// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "keepout/robot/instrument_constraint.h"

namespace keepout {

/// The names of the parts of an instrument constraint, and its options.
struct InstrumentConstraintSettings {
  std::string index = "wide_bvh";  // see index_backends(); fcl_collide is not for real time
  /// The directory of saved indices; only wide_bvh is saved. Empty: indices are not saved.
  std::filesystem::path index_cache = {};
  std::string solver = "active_set";  // see solver_backends()
  bool monitor = false;  // a monitor confirms each motion: see InstrumentConstraint::set_monitor
  InstrumentOptions options = {};    // the same in all cycles
  InstrumentCapacity capacity = {};  // of the memory that all cycles use
  /// Called while building, with two kinds of harmless warnings. Either the index could not be
  /// saved, or steps are slow because the mesh is so large relative to the margin. May be empty.
  std::function<void(const std::string&)> warn = {};
};

/// The table of the settings that are neither in InstrumentOptions nor in InstrumentCapacity.
inline constexpr std::array instrument_settings{
    option<&InstrumentConstraintSettings::solver>(
        "solver", "Solver of the step problem: see solver_backends()."),
    option<&InstrumentConstraintSettings::monitor>("monitor",
                                                   "True if an independent monitor must confirm "
                                                   "each motion. A motion that it does not confirm "
                                                   "is not made: the status is unconfirmed.")};

/// See table_of(const StepOptions&).
constexpr const auto& table_of(const InstrumentConstraintSettings&) { return instrument_settings; }

/// Builds the parts and combines them. Throws Error for an unknown name, with a list of the known
/// names, and for settings out of range.
InstrumentConstraint make_instrument_constraint(std::shared_ptr<const Mesh> mesh,
                                                Instrument instrument,
                                                const InstrumentConstraintSettings& settings);

/// Like the function above, but on an existing index of this mesh: ignores settings.index and
/// index_cache. Constraints of several threads may share mesh and index.
InstrumentConstraint make_instrument_constraint(std::shared_ptr<const Mesh> mesh,
                                                std::shared_ptr<const SpatialIndex> index,
                                                Instrument instrument,
                                                const InstrumentConstraintSettings& settings);

}  // namespace keepout
