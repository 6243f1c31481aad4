// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/adapters/all_indices.h"

#include "keepout/adapters/gpl_index_registry.h"

namespace keepout {
namespace {

template <class Part>
std::vector<Part> joined(std::span<const Part> ours, std::span<const Part> gpl) {
  std::vector<Part> all(ours.begin(), ours.end());
  all.insert(all.end(), gpl.begin(), gpl.end());
  return all;
}

}  // namespace

std::vector<IndexBackend> all_index_backends() {
  return joined(index_backends(), gpl_index_backends());
}

std::vector<AbsentPart> all_absent_index_backends() {
  return joined(absent_index_backends(), absent_gpl_index_backends());
}

}  // namespace keepout
