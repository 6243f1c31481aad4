// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/benchmark.h"
#include "bench/combination.h"
#include "bench/reference.h"
#include "bench/subject.h"
#include "stop_signal.h"

namespace keepout::app {

enum class Poses {
  contact,   // a tool that presses on the surface and slides along it, cycle after cycle
  unrelated  // all over the surface, as a planner asks
};

struct TrialSettings {
  std::size_t queries = 2500;  // of each combination, at most
  double seconds = 1.0;        // after which a combination is asked no more: see measure()
  double margin = 0.2;         // of the certified rule, and from the tip to the surface [mm]
  Poses poses = Poses::contact;
  std::uint64_t seed = 1;
};

/// What an index takes, by its name, as seen on another mesh. [bytes per triangle]
using MemoryTaken = std::map<std::string, double>;

/// One mesh, and the same motions for every combination.
class Trial {
 public:
  /// `memory` must outlive this, and is added to; so must `stop`, at which work ends early. Throws
  /// Error when there is no such mesh.
  Trial(const Subject& subject, const TrialSettings& settings, MemoryTaken& memory,
        const StopSignal& stop);

  /// Builds the index unless the combination before had the same. What cannot be built, or gives a
  /// wrong answer, is not timed, and the row's remark says why. Of no use once it was stopped.
  BenchmarkRow measure(const Combination& combination);

  const Mesh& mesh() const noexcept { return *mesh_; }

  /// What reading its file took, and the cores it kept busy.
  const LoadedSubject& loaded() const noexcept { return loaded_; }

 private:
  void build(const std::string& index);
  MotionConstraint& guard(const MotionConstraintSettings& settings);
  Reference& reference(const MotionConstraintSettings& settings);

  Subject subject_;
  TrialSettings settings_;
  MemoryTaken& memory_;
  const StopSignal& stop_;
  LoadedSubject loaded_;
  std::shared_ptr<const Mesh> mesh_;
  std::vector<Motion> motions_;
  std::shared_ptr<const SpatialIndex> reference_index_;
  std::map<std::string, MotionConstraint> guards_;                  // of each rule
  std::map<std::pair<std::string, double>, Reference> references_;  // of each rule and radius
  std::shared_ptr<const SpatialIndex> index_;                       // at hand; null: not built
  BenchmarkRow row_;  // so much of it as is the same for all combinations with that index
};

}  // namespace keepout::app
