// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "capacity.h"

#include <string>

#include "keepout/error.h"

namespace keepout {

void require_at_most(std::size_t most, std::size_t count, std::string_view items,
                     std::string_view index) {
  if (count <= most) return;
  throw Error("the index '" + std::string(index) + "' holds at most " + std::to_string(most) + " " +
              std::string(items) + ", and the mesh has " + std::to_string(count) +
              "; use 'pd_tree', which holds more, or decimate the mesh");
}

}  // namespace keepout
