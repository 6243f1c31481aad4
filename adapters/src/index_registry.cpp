// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/adapters/index_registry.h"

#include <array>
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

constexpr std::array backends{
    IndexBackend{"brute_force", "every triangle, one after the other: the oracle",
                 make<BruteForce>},
    IndexBackend{"pd_tree", "principal direction tree of oriented boxes (Williams et al. 1997)",
                 make<PdTree>},
};

}  // namespace

std::span<const IndexBackend> index_backends() noexcept { return backends; }

std::unique_ptr<SpatialIndex> make_index(std::string_view name, std::shared_ptr<const Mesh> mesh) {
  return entry_named(name, backends, "index").make(std::move(mesh));
}

}  // namespace keepout
