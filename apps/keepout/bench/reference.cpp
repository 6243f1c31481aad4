// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/reference.h"

#include <algorithm>
#include <utility>

#include "bench/bit_hash.h"
#include "keepout/error.h"
#include "keepout/index/brute_force.h"
#include "keepout/solvers/active_set.h"

namespace keepout::app {
namespace {

/// Brute force is asked about so many of the motions: tens of milliseconds each.
constexpr std::size_t sample_count = 8;

bool is_same(const Hit& one, const Hit& other) {
  return one.triangle == other.triangle && one.closest.offset == other.closest.offset &&
         one.closest.distance == other.closest.distance &&
         one.closest.feature == other.closest.feature;
}

}  // namespace

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

Reference::Reference(std::shared_ptr<const Mesh> mesh, const SpatialIndex& index, Activation& rule,
                     Workspace& work, const RuleSetting& setting, std::span<const Motion> motions)
    : mesh_(std::move(mesh)),
      work_(work),
      setting_(setting),
      motions_(motions),
      solver_(std::make_unique<ActiveSet>()),
      pipeline_{*mesh_, index, rule, *solver_, work_, setting_} {
  solver_->reserve(3, static_cast<int>(work_.planes.capacity()));
  for (const Motion& motion : motions_) balls_.push_back(ball_of(setting_, rule, motion));
  const BruteForce brute_force(mesh_);
  const Pipeline exhaustive{*mesh_, brute_force, rule, *solver_, work_, setting_};
  for (std::size_t s = 0; s < sample_count; ++s) {
    const std::size_t motion = s * motions_.size() / sample_count;
    samples_.push_back({motion, hits_of(brute_force, balls_[motion])});
    fits_ = fits_ && !work_.candidates.overflowed();
    if (!fits_) return;
    if (pipeline_.ask(motions_[motion]) != exhaustive.ask(motions_[motion])) {
      throw Error(
          "the steps of the reference are not those of brute force: this is a fault in "
          "keepout; please report it");
    }
  }
  if (!is_found_by(index)) throw Error("the reference's index misses triangles: please report it");
}

Reference::~Reference() = default;

const Answer& Reference::answer(std::size_t motion) {
  while (answers_.size() <= motion) answers_.push_back(pipeline_.ask(motions_[answers_.size()]));
  return answers_[motion];
}

std::uint64_t Reference::hits_hash(std::size_t motion) {
  while (hits_hashes_.size() <= motion) {
    hits_hashes_.push_back(hash_of(hits_of(pipeline_.index, balls_[hits_hashes_.size()])));
  }
  return hits_hashes_[motion];
}

bool Reference::is_found_by(const SpatialIndex& index) {
  return std::ranges::all_of(samples_, [&](const Sample& sample) {
    return std::ranges::equal(hits_of(index, balls_[sample.motion]), sample.hits, is_same);
  });
}

std::vector<Hit> Reference::hits_of(const SpatialIndex& index, const Ball& ball) {
  work_.candidates.clear();
  work_.hits.clear();
  index.collect(ball, work_.candidates);
  refine(*mesh_, ball, work_.candidates.view(), work_.hits);
  return {work_.hits.begin(), work_.hits.end()};
}

}  // namespace keepout::app
