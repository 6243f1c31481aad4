// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/index/query.h"

namespace keepout::app {

/// Tells whether answers are the same, bit for bit: like FNV-1a, but of whole words.
class BitHash {
 public:
  void add(std::uint64_t word) {
    value_ = (value_ ^ word) * 0x100000001B3;
    value_ ^= value_ >> 32;
  }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x + 0.0)); }  // -0 is 0

  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325;
};

/// Whether two queries found the same there, to the last bit.
bool is_same(const Hit& one, const Hit& other);

/// Of what a query finds, to the last bit.
std::uint64_t hash_of(std::span<const Hit> hits);

/// What a step came to.
struct Answer {
  Answer(const Step& step) : status(step.status), motion(step.motion) {}
  bool operator==(const Answer&) const = default;

  Status status;
  Vec3 motion;
};

/// What every index and solver is held to, for one rule and radius on one mesh: brute force, in a
/// sample of the places; everywhere, the reference's guard, which is held to brute force too.
class Reference {
 public:
  /// The guard is one with these settings, but that its radius may be another, on an index that is
  /// right and with our own solver. Guard and motions must outlive this. Throws Error when the
  /// guard's own parts are not right: a fault of ours.
  Reference(MotionConstraint& guard, std::shared_ptr<const Mesh> mesh,
            const MotionConstraintSettings& settings, std::span<const Motion> motions);

  /// Whether there is room for all triangles in reach. If not, ask no more of it.
  bool fits() const noexcept { return fits_; }

  /// The step that is expected for a motion.
  const Answer& answer(std::size_t motion);

  /// The hash of what a query finds there.
  std::uint64_t hits_hash(std::size_t motion);

  /// Whether a motion is accepted for its proof, and not because a solver says that it is the best.
  bool proves_motions() const noexcept { return proves_motions_; }

  const Mesh& mesh() const noexcept { return guard_.mesh(); }

  /// Where the rule looks at first, for each motion.
  std::span<const Ball> balls() const noexcept { return balls_; }

  /// Whether the index finds in every sampled ball what brute force finds, to the bit.
  bool is_found_by(const SpatialIndex& index);

  // What a query finds, for whoever makes one.
  TriangleBuffer candidates;
  HitBuffer hits;

 private:
  struct Sample {
    std::size_t motion;
    std::vector<Hit> hits;
  };

  std::span<const Hit> hits_of(const SpatialIndex& index, const Ball& ball);

  MotionConstraint& guard_;
  StepOptions options_;
  bool proves_motions_;
  std::span<const Motion> motions_;
  std::vector<Ball> balls_;
  std::vector<Sample> samples_;
  std::vector<Answer> answers_;             // as far as they have been asked for
  std::vector<std::uint64_t> hits_hashes_;  // likewise
  bool fits_ = true;
};

}  // namespace keepout::app
