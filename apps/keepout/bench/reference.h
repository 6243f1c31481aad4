// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "bench/pipeline.h"
#include "keepout/index/refine.h"

namespace keepout::app {

/// Of what a query finds, to the last bit.
std::uint64_t hash_of(std::span<const Hit> hits);

/// What every index and solver is held to, for one rule and radius on one mesh: brute force, in a
/// sample of the places; everywhere, pd_tree and active_set with the rule's plain form, which are
/// held to brute force too.
class Reference {
 public:
  /// All must outlive this. Throws Error when the reference's own parts are not right: a fault of
  /// ours.
  Reference(std::shared_ptr<const Mesh> mesh, const SpatialIndex& index, Activation& rule,
            Workspace& work, const RuleSetting& setting, std::span<const Motion> motions);
  ~Reference();

  /// Whether the workspace has room for all triangles in reach. If not, ask no more of it.
  bool fits() const noexcept { return fits_; }

  /// The step that is expected for a motion.
  const Answer& answer(std::size_t motion);

  /// The hash of what a query finds there.
  std::uint64_t hits_hash(std::size_t motion);

  const Mesh& mesh() const noexcept { return *mesh_; }
  Workspace& work() const noexcept { return work_; }
  const RuleSetting& setting() const noexcept { return setting_; }

  /// Where the rule looks at first, for each motion.
  std::span<const Ball> balls() const noexcept { return balls_; }

  /// Whether the index finds in every sampled ball what brute force finds, to the bit.
  bool is_found_by(const SpatialIndex& index);

 private:
  struct Sample {
    std::size_t motion;
    std::vector<Hit> hits;
  };

  std::vector<Hit> hits_of(const SpatialIndex& index, const Ball& ball);

  std::shared_ptr<const Mesh> mesh_;
  Workspace& work_;
  RuleSetting setting_;
  std::span<const Motion> motions_;
  std::unique_ptr<Solver> solver_;
  Pipeline pipeline_;
  std::vector<Ball> balls_;
  std::vector<Sample> samples_;
  std::vector<Answer> answers_;             // as far as they have been asked for
  std::vector<std::uint64_t> hits_hashes_;  // likewise
  bool fits_ = true;
};

}  // namespace keepout::app
