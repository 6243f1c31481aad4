// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "keepout/robot/instrument_constraint.h"

namespace keepout {

/// Parts of an instrument constraint, by name, and its options.
struct InstrumentConstraintSettings {
  std::string index = "wide_bvh";  // see index_backends(); fcl_collide is not for real time
  /// The folder where built indices are kept; only wide_bvh is. Empty: none is kept.
  std::filesystem::path index_cache = {};
  std::string solver = "active_set";  // see solver_backends()
  InstrumentOptions options = {};     // that stay the same from cycle to cycle
  InstrumentCapacity capacity = {};   // for the largest cycle
  /// Called while building with what does no harm but should be known: the index could not be kept,
  /// or the mesh is so large beside the margin that steps are slow. May be empty.
  std::function<void(const std::string&)> warn = {};
};

/// The table of the settings that are neither in InstrumentOptions nor in InstrumentCapacity.
inline constexpr std::array instrument_settings{option<&InstrumentConstraintSettings::solver>(
    "solver", "Solver of the step problem: see solver_backends().")};

/// See table_of(const StepOptions&).
constexpr const auto& table_of(const InstrumentConstraintSettings&) { return instrument_settings; }

/// Builds the parts and puts them together. Throws Error, listing what exists, for a name that does
/// not, and for settings out of range.
InstrumentConstraint make_instrument_constraint(std::shared_ptr<const Mesh> mesh,
                                                Instrument instrument,
                                                const InstrumentConstraintSettings& settings);

/// The same on an index that is there already, built on this mesh: settings.index and index_cache
/// are not looked at. Constraints of many threads may share it, as they share the mesh.
InstrumentConstraint make_instrument_constraint(std::shared_ptr<const Mesh> mesh,
                                                std::shared_ptr<const SpatialIndex> index,
                                                Instrument instrument,
                                                const InstrumentConstraintSettings& settings);

}  // namespace keepout
