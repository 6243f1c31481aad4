// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/searcher.h"

#include <algorithm>

#include "bench/speed/lean_test.h"
#include "keepout/error.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/index/brute_force.h"

namespace keepout::app {
namespace {

constexpr std::size_t room = std::size_t{1} << 18;

/// Brute force is asked at so many places: tens of milliseconds each.
constexpr std::size_t sample_count = 8;

}  // namespace

Searcher::Searcher(const Mesh& mesh, const SpatialIndex& index, double radius)
    : mesh_(mesh),
      index_(index),
      radius_(radius),
      candidates_(std::min(room, mesh.triangle_count())),
      found_(candidates_.capacity()) {}

void Searcher::collect(const Vec3& place) noexcept {
  candidates_.clear();
  index_.collect({place, radius_}, candidates_);
}

std::span<const TriangleId> Searcher::answer(const Vec3& place, Decider decider) noexcept {
  collect(place);
  if (index_.is_exact()) return candidates_.view();
  found_.clear();
  for (const TriangleId t : candidates_) {
    const Triangle triangle = mesh_.triangle(t);
    const bool touches = decider == Decider::kernel
                             ? closest_point(triangle, place).distance <= radius_
                             : touches_ball(triangle, place, radius_);
    if (touches) found_.push(t);
  }
  return found_.view();
}

std::vector<TriangleId> Searcher::sorted_answer(const Vec3& place, Decider decider) {
  const std::span<const TriangleId> ids = answer(place, decider);
  if (candidates_.overflowed()) throw Error("too many triangles are within reach of a query");
  std::vector<TriangleId> sorted(ids.begin(), ids.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

Question::Question(std::shared_ptr<const Mesh> mesh, const SpatialIndex& right, double radius,
                   std::span<const Vec3> places)
    : radius_(radius), places_(places) {
  Searcher searcher(*mesh, right, radius);
  for (const Vec3& place : places) answers_.push_back(searcher.sorted_answer(place));
  const BruteForce brute_force(mesh);
  Searcher oracle(*mesh, brute_force, radius);
  for (std::size_t i = 0; i < std::min(sample_count, places.size()); ++i) {
    if (oracle.sorted_answer(places[i]) != answers_[i]) {
      throw Error("the index's triangles are not those of brute force: please report it");
    }
  }
}

double Question::found_mean() const noexcept {
  std::size_t sum = 0;
  for (const std::vector<TriangleId>& answer : answers_) sum += answer.size();
  return static_cast<double>(sum) / static_cast<double>(answers_.size());
}

std::size_t Question::wrong_answers(Searcher& searcher, Decider decider) const {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (searcher.sorted_answer(places_[i], decider) != answers_[i]) ++wrong;
  }
  return wrong;
}

}  // namespace keepout::app
