// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "keepout/error.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/mesh/mesh.h"

namespace keepout::app {

/// A mesh to measure on.
struct Subject {
  std::string mesh;           // the name of a sample mesh, or a file
  std::size_t triangles = 0;  // the bunny scaled and resampled to this size; 0: as in the file
  LoadOptions load = {};
};

/// The mesh for curves over the number of triangles, as in Li et al. (2020).
inline constexpr std::string_view resampled_mesh = "bunny";

/// Returns the name of the mesh; for a file without its directory.
std::string label_of(const Subject& subject);

/// Returns text such as "bunny, 989,376 triangles".
std::string title_of(const Subject& subject);

/// Returns work(). Puts the name of the mesh before the text of an Error.
template <class Work>
auto naming(const Subject& subject, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(label_of(subject) + ": " + error.what());
  }
}

/// Measures how many cores this process and others have kept busy since the object was made.
class UsedCores {
 public:
  UsedCores();

  /// Returns the time since then. [s]
  double seconds() const;

  /// Returns the mean number of cores that all threads of this process kept busy.
  double own() const;

  /// Returns the mean number of cores that other processes kept busy; empty if the system does not
  /// report it.
  std::optional<double> others() const;

 private:
  std::chrono::steady_clock::time_point start_;
  double own_start_;                 // [s]
  std::optional<double> all_start_;  // [s]
};

/// A mesh, and the time to read its file, before resampling.
struct LoadedSubject {
  std::shared_ptr<const Mesh> mesh;
  double seconds;  // [s]
  double cores;    // mean number of busy cores
};

/// Reads a mesh and resamples it if required: the bunny is 150 mm large, as in Li et al. (2020).
/// Throws Error.
LoadedSubject load(const Subject& subject);
std::shared_ptr<const Mesh> make_mesh(const Subject& subject);

/// Returns a copy that may be changed.
Surface surface_of(const Mesh& mesh);

}  // namespace keepout::app
