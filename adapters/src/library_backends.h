// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <vector>

#include "keepout/adapters/index_registry.h"
#include "keepout/adapters/narrow_phase_registry.h"

namespace keepout {

// What each library's folder has for the registries: there only in a build with the library.

std::span<const IndexBackend> fcl_indices() noexcept;
std::span<const IndexBackend> bullet_indices() noexcept;
std::span<const IndexBackend> embree_indices() noexcept;
/// Under the GPL: for keepout::all_indices alone.
std::span<const IndexBackend> cgal_indices() noexcept;

std::span<const NarrowPhaseBackend> ccd_narrow_phases() noexcept;
std::span<const NarrowPhaseBackend> fcl_narrow_phases() noexcept;

// What an absent part needs.
inline constexpr std::string_view needs_fcl =
    "FCL (install libfcl-dev, configure with KEEPOUT_WITH_FCL=ON)";
inline constexpr std::string_view needs_bullet =
    "Bullet (install libbullet-dev and pkg-config, configure with KEEPOUT_WITH_BULLET=ON)";
inline constexpr std::string_view needs_ccd =
    "libccd (install libccd-dev, configure with KEEPOUT_WITH_CCD=ON)";

/// An index on a mesh that it holds on to, in the form that the registry knows.
template <class Index>
std::unique_ptr<SpatialIndex> make_index_of(std::shared_ptr<const Mesh> mesh) {
  return std::make_unique<Index>(std::move(mesh));
}

/// A narrow phase of a tool, in the form that the registry knows.
template <class Phase>
std::unique_ptr<NarrowPhase> make_narrow_phase_of(const ConvexTool& tool) {
  return std::make_unique<Phase>(tool);
}

/// Throws Error when `count` is more than `most`, what the data structure of the index of that name
/// can hold. `items` says what is counted: triangles or vertices.
void require_at_most(std::size_t most, std::size_t count, std::string_view items,
                     std::string_view index);

/// The rows of several tables, one after the other.
template <class Row>
std::vector<Row> joined(std::initializer_list<std::span<const Row>> tables) {
  std::vector<Row> all;
  for (const std::span<const Row> rows : tables) all.insert(all.end(), rows.begin(), rows.end());
  return all;
}

}  // namespace keepout
