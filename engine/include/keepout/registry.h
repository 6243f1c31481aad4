// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "keepout/error.h"

namespace keepout {

/// Of the known names the one that was probably meant by a mistyped one, for "did you mean": the
/// one with the fewest letters put in, left out, exchanged or swapped with their neighbor, if they
/// are at most a third of all; else the first that has all of it in one piece. Capitals count as
/// small letters, '_' as '-'. Of equals the first; nothing if none is close. Allocates.
std::optional<std::string_view> nearest_name(std::string_view mistyped,
                                             std::span<const std::string_view> names);

/// Whether a part takes memory from the heap while it answers.
enum class Allocation : std::uint8_t {
  never,  // fit for the control path
  inside  // the library behind it does: for comparison, not for real time
};

/// A part of another library, which a module of ours brings: see keepout/module.h.
struct PeerPart {
  std::string_view name;         // to ask for it by
  std::string_view needs;        // the library, its Debian package and our option
  const char* module = nullptr;  // the name of its file, without .so
};

/// Throws Error for a name that no part of a kind has. The message lists the names there are and
/// suggests the nearest one, or says what an absent part needs. `what` is the kind of part.
[[noreturn]] void refuse_name(std::string_view name, std::span<const std::string_view> known,
                              std::string_view what, std::span<const PeerPart> absent);

/// All parts of one kind that this build has, to choose from by name: a view of tables that last as
/// long as the program.
template <class Part>
class Registry : public std::span<const Part> {
 public:
  /// `kind`: as messages name it.
  Registry(std::string_view kind, std::span<const Part> parts,
           std::span<const PeerPart> absent = {}) noexcept
      : std::span<const Part>(parts), kind_(kind), absent_(absent) {}

  /// The parts of other libraries that cannot be had here.
  std::span<const PeerPart> absent() const noexcept { return absent_; }

  /// Returns true if there is a part of that name.
  bool has(std::string_view name) const noexcept { return find(name) != nullptr; }

  /// Returns the part of that name. Throws Error, as refuse_name does, if there is none.
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
