// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "keepout/error.h"

namespace keepout {

/// The entry of a table of parts with that name. Throws Error, listing the names there are, when
/// there is none. `what` says what kind of part it is.
template <class Table>
const auto& entry_named(std::string_view name, const Table& table, std::string_view what) {
  std::string known;
  for (const auto& entry : table) {
    if (entry.name == name) return entry;
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw Error("there is no " + std::string(what) + " '" + std::string(name) + "'; known: " + known);
}

}  // namespace keepout
