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

/// A mesh to be measured on.
struct Subject {
  std::string mesh;           // the name of a real fixture, or a file
  std::size_t triangles = 0;  // the bunny, scaled and resampled to so many; 0: as it is in the file
  LoadOptions load = {};
};

/// The mesh of which a curve over the number of triangles is made: the paper's.
inline constexpr std::string_view resampled_mesh = "bunny";

/// What to call its mesh: a file without its folder.
std::string label_of(const Subject& subject);

/// "bunny, 989,376 triangles".
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

/// How many cores were busy since it was made, in the mean: with this process, and with others.
class UsedCores {
 public:
  UsedCores();

  /// The time since. [s]
  double seconds() const;

  /// Cores that all threads of this process kept busy.
  double own() const;

  /// Cores that other processes kept busy; nothing where the system does not tell.
  std::optional<double> others() const;

 private:
  std::chrono::steady_clock::time_point start_;
  double own_start_;                 // [s]
  std::optional<double> all_start_;  // [s]
};

/// A mesh, and what reading its file took, before anything is resampled.
struct LoadedSubject {
  std::shared_ptr<const Mesh> mesh;
  double seconds;  // [s]
  double cores;    // kept busy meanwhile, in the mean
};

/// Reads or makes it: the bunny 150 mm large, as in the paper. Throws Error.
LoadedSubject load(const Subject& subject);
std::shared_ptr<const Mesh> make_mesh(const Subject& subject);

/// A copy, to be changed.
Surface surface_of(const Mesh& mesh);

}  // namespace keepout::app
