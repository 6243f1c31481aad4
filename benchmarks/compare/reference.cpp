// SPDX-License-Identifier: BSD-3-Clause
#include "compare/reference.h"

#include <algorithm>
#include <utility>

#include "keepout/error.h"
#include "keepout/index/brute_force.h"

namespace keepout::app {
namespace {

/// Brute force is asked about so many of the motions: tens of milliseconds each.
constexpr std::size_t sample_count = 8;

}  // namespace

bool is_same(const Hit& one, const Hit& other) {
  return one.triangle == other.triangle && one.closest.offset == other.closest.offset &&
         one.closest.distance == other.closest.distance &&
         one.closest.feature == other.closest.feature;
}

std::uint64_t hash_of(std::span<const Hit> hits) {
  BitHash hash;
  for (const Hit& hit : hits) {
    hash.add(std::uint64_t{hit.triangle});
    for (const double x : hit.closest.offset) hash.add(x);
    hash.add(hit.closest.distance);
    hash.add(static_cast<std::uint64_t>(hit.closest.feature));
  }
  return hash.value();
}

Reference::Reference(MotionConstraint& guard, std::shared_ptr<const Mesh> mesh,
                     const MotionConstraintSettings& settings, std::span<const Motion> motions)
    : candidates(std::min(settings.capacity.triangles, mesh->triangle_count())),
      hits(candidates.capacity()),
      guard_(guard),
      options_({.radius = settings.options.radius, .margin = settings.options.margin}),
      proves_motions_(settings.activation == "certified"),
      motions_(motions) {
  const auto brute_force = std::make_shared<const BruteForce>(mesh);
  MotionConstraint exhaustive = make_motion_constraint(std::move(mesh), brute_force, settings);
  guard.set_options(options_);
  for (const Motion& motion : motions_) balls_.push_back(guard.region(motion));
  for (std::size_t s = 0; s < sample_count; ++s) {
    const std::size_t motion = s * motions_.size() / sample_count;
    const std::span<const Hit> found = hits_of(*brute_force, balls_[motion]);
    samples_.push_back({motion, {found.begin(), found.end()}});
    fits_ = fits_ && !candidates.overflowed();
    if (!fits_) return;
    const Answer expected = exhaustive.step(motions_[motion]);
    if (Answer(guard.step(motions_[motion])) != expected) {
      throw Error(
          "the steps of the reference are not those of brute force: this is a fault in "
          "keepout; please report it");
    }
  }
  if (!is_found_by(guard.index())) {
    throw Error("the reference's index misses triangles: please report it");
  }
}

const Answer& Reference::answer(std::size_t motion) {
  if (answers_.size() <= motion) guard_.set_options(options_);
  while (answers_.size() <= motion) {
    answers_.push_back(guard_.step(motions_[answers_.size()]));
  }
  return answers_[motion];
}

std::uint64_t Reference::hits_hash(std::size_t motion) {
  while (hits_hashes_.size() <= motion) {
    hits_hashes_.push_back(hash_of(hits_of(guard_.index(), balls_[hits_hashes_.size()])));
  }
  return hits_hashes_[motion];
}

bool Reference::is_found_by(const SpatialIndex& index) {
  return std::ranges::all_of(samples_, [&](const Sample& sample) {
    return std::ranges::equal(hits_of(index, balls_[sample.motion]), sample.hits, is_same);
  });
}

std::span<const Hit> Reference::hits_of(const SpatialIndex& index, const Ball& ball) {
  candidates.clear();
  hits.clear();
  index.collect(ball, candidates);
  refine(mesh(), ball, candidates.view(), hits);
  return hits.view();
}

}  // namespace keepout::app
