// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "keepout/error.h"

namespace keepout {

/// Returns the known name that is most similar to a mistyped one, for "did you mean". The most
/// similar name differs by the fewest letters that are inserted, deleted, replaced or swapped with
/// their neighbor. If these are more than a third of the letters for every name, returns the first
/// name that contains the mistyped one. Upper and lower case are equal, and so are '_' and '-'. If
/// several names are equally similar, returns the first. Returns empty if no name is similar.
/// Allocates.
std::optional<std::string_view> nearest_name(std::string_view mistyped,
                                             std::span<const std::string_view> names);

/// The use of heap memory by a part while it computes.
enum class Allocation : std::uint8_t {
  never,  // suitable for the control path
  inside  // the underlying library allocates: for comparison, not for real time
};

/// A part (index, narrow phase or solver) that uses another library. A module provides it: see
/// keepout/module.h.
struct PeerPart {
  std::string_view name;         // for Registry::named
  std::string_view needs;        // the library, its Debian package and the build option
  const char* module = nullptr;  // the name of the module's file, without .so
};

/// Throws Error for a name that no part has. The message lists the known names and suggests the
/// most similar one, or reports what an absent part needs. `what`: the kind of part.
[[noreturn]] void refuse_name(std::string_view name, std::span<const std::string_view> known,
                              std::string_view what, std::span<const PeerPart> absent);

/// All available parts of one kind, by name: a view of tables that live as long as the program.
template <class Part>
class Registry : public std::span<const Part> {
 public:
  /// Makes the view. `kind`: the name of the parts in messages.
  Registry(std::string_view kind, std::span<const Part> parts,
           std::span<const PeerPart> absent = {}) noexcept
      : std::span<const Part>(parts), kind_(kind), absent_(absent) {}

  /// Returns the parts of other libraries that are not available.
  std::span<const PeerPart> absent() const noexcept { return absent_; }

  /// Returns true if there is a part of that name.
  bool has(std::string_view name) const noexcept { return find(name) != nullptr; }

  /// Returns the part of that name. Throws Error, like refuse_name, if there is no such part.
  const Part& named(std::string_view name) const {
    if (const Part* const part = find(name)) return *part;
    std::vector<std::string_view> known;
    for (const Part& part : *this) known.push_back(part.name);
    refuse_name(name, known, kind_, absent_);
  }

 private:
  const Part* find(std::string_view name) const noexcept {
    for (const Part& part : *this) {
      if (part.name == name) return &part;
    }
    return nullptr;
  }

  std::string_view kind_;
  std::span<const PeerPart> absent_;
};

}  // namespace keepout
