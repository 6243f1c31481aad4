// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/adapters/index_registry.h"

#include <utility>

#include "keepout/index/brute_force.h"
#include "keepout/index/pd_tree.h"
#include "keepout/registry.h"

namespace keepout {
namespace {

template <class T>
std::unique_ptr<SpatialIndex> make(std::shared_ptr<const Mesh> mesh) {
  return std::make_unique<T>(std::move(mesh));
}

constexpr std::size_t as_many_as_a_mesh = no_triangle;

constexpr IndexBackend backends[] = {
    {"brute_force", "every triangle, one after the other: the oracle", make<BruteForce>,
     as_many_as_a_mesh, nullptr},
    {"pd_tree", "principal direction tree of oriented boxes (Williams et al. 1997)", make<PdTree>,
     as_many_as_a_mesh, nullptr},
};

}  // namespace

std::span<const IndexBackend> index_backends() noexcept { return backends; }

std::span<const AbsentPart> absent_index_backends() noexcept { return {}; }

std::unique_ptr<SpatialIndex> make_index(std::string_view name, std::shared_ptr<const Mesh> mesh) {
  return entry_named(name, backends, "index", absent_index_backends()).make(std::move(mesh));
}

}  // namespace keepout
