// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/registry.h"
#include "keepout/version.h"

/// Marks a shared object as a module or plugin for this version of keepout. Write it once in its
/// sources, outside of all namespaces.
#define KEEPOUT_MODULE()                                                         \
  extern "C" [[gnu::visibility("default")]] const char keepout_module_version[]; \
  extern "C" const char keepout_module_version[] = KEEPOUT_VERSION

namespace keepout {

// Here, a part is an index, a narrow phase or a solver. A module is a shared object, such as
// keepout-modules/fcl.so, with parts that use another library. Only the module links that library.
// keepout loads a module at the first request for one of its parts. It searches the directory in
// the environment variable KEEPOUT_MODULES. Without that variable, it searches the directory
// `keepout-modules` beside the program or the library, or in the library directory of their
// installation prefix.
//
// A plugin is a module of a user, which exports the same tables. Its name is the path of its file.

/// Returns true if the file of the module exists. `module`: a name, or the path of a plugin with at
/// least one slash.
bool has_module(const char* module);

/// Returns the address of a table that the module exports under the name `table`; null if the
/// module or the table does not exist. Loads the module the first time. Throws Error if the module
/// cannot be loaded, or is for another version of keepout.
const void* table_in_module(const char* module, const char* table);

/// Returns the parts that the module exports as a std::span<const Part> under the name `table`;
/// otherwise like table_in_module.
template <class Part>
std::span<const Part> parts_in_module(const char* module, const char* table) {
  const void* const parts = table_in_module(module, table);
  return parts == nullptr ? std::span<const Part>{}
                          : *static_cast<const std::span<const Part>*>(parts);
}

/// The table of all parts of one kind: keepout's own, those in modules, and those in plugins. A
/// table must live as long as the program.
template <class Part>
class PartTable {
 public:
  /// Makes the table. `kind`: the name of the parts in messages. `table`: the name of their tables
  /// in modules.
  PartTable(std::string_view kind, std::span<const Part> own, std::span<const PeerPart> peers,
            const char* table)
      : kind_(kind), own_(own), peers_(peers), table_(table) {}

  /// Adds the parts of a plugin, and returns their number. `file`: a path with at least one slash.
  /// Throws Error if the file cannot be loaded, is for another version of keepout, or has a part
  /// with a name that another part has. Precondition: before all(), and before other threads use
  /// the table.
  std::size_t add(const std::string& file) {
    const auto parts = parts_in_module<Part>(file.c_str(), table_);
    for (const Part& part : parts) {
      const bool is_peer = std::ranges::find(peers_, part.name, &PeerPart::name) != peers_.end();
      if (is_peer || with_name(own_, part.name) || with_name(plugged_, part.name)) {
        throw Error("the plugin " + file + " has the " + std::string(kind_) + " '" +
                    std::string(part.name) + "', and another part has that name: rename it");
      }
      plugged_.push_back(part);
    }
    return parts.size();
  }

  /// Returns all parts, keepout's own first. Loads all existing modules. Parts of a module that
  /// cannot be loaded are absent.
  Registry<Part> all() const {
    std::call_once(is_complete_, [this] {
      all_.assign(own_.begin(), own_.end());
      all_.insert(all_.end(), plugged_.begin(), plugged_.end());
      for (const PeerPart& peer : peers_) {
        if (const Part* const part = loaded(peer)) {
          all_.push_back(*part);
        } else {
          absent_.push_back(peer);
        }
      }
    });
    return {kind_, all_, absent_};
  }

  /// Returns the part of that name. Loads no module except that of the part. Throws Error for an
  /// unknown or absent part, like refuse_name, and for a module that cannot be loaded.
  const Part& named(std::string_view name) const {
    if (const Part* const own = with_name(own_, name)) return *own;
    if (const Part* const plugged = with_name(plugged_, name)) return *plugged;
    for (const PeerPart& peer : peers_) {
      if (peer.name != name) continue;
      const auto parts = parts_in_module<Part>(peer.module, table_);
      if (const Part* const part = with_name(parts, name)) return *part;
    }
    return all().named(name);
  }

  /// Returns the names of the available parts. Loads no module.
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Part& part : own_) names.emplace_back(part.name);
    for (const Part& part : plugged_) names.emplace_back(part.name);
    for (const PeerPart& peer : peers_) {
      if (has_module(peer.module)) names.emplace_back(peer.name);
    }
    return names;
  }

 private:
  static const Part* with_name(std::span<const Part> parts, std::string_view name) noexcept {
    for (const Part& part : parts) {
      if (part.name == name) return &part;
    }
    return nullptr;
  }

  /// Returns the part, or null if its module is absent or cannot be loaded.
  const Part* loaded(const PeerPart& peer) const {
    try {
      return with_name(parts_in_module<Part>(peer.module, table_), peer.name);
    } catch (const Error&) {
      return nullptr;
    }
  }

  std::string_view kind_;
  std::span<const Part> own_;
  std::span<const PeerPart> peers_;
  const char* table_;
  std::vector<Part> plugged_;           // of plugins
  mutable std::once_flag is_complete_;  // of all_ and absent_
  mutable std::vector<Part> all_;
  mutable std::vector<PeerPart> absent_;
};

}  // namespace keepout
