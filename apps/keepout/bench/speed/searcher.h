// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "keepout/buffer.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout::app {

/// What decides of a candidate.
enum class Decider {
  kernel,    // the engine's, which every step uses
  lean_test  // the least that decides the same: see lean_test.h
};

/// Asks an index for the triangles within balls of one radius.
class Searcher {
 public:
  /// Both must outlive this.
  Searcher(const Mesh& mesh, const SpatialIndex& index, double radius);

  void collect(const Vec3& place) noexcept;

  /// The candidates if they are the answer; else those of them that an exact test leaves.
  std::span<const TriangleId> answer(const Vec3& place, Decider decider) noexcept;

  /// The same in the order of their numbers. Throws Error if they are more than there is room for.
  std::vector<TriangleId> sorted_answer(const Vec3& place, Decider decider = Decider::kernel);

 private:
  const Mesh& mesh_;
  const SpatialIndex& index_;
  double radius_;
  TriangleBuffer candidates_, found_;
};

/// The answers of an index that is right, for others to be held to.
class Question {
 public:
  /// Mesh and places must outlive this. Throws Error when the index does not agree with brute force
  /// in a sample of the places: a fault of ours.
  Question(std::shared_ptr<const Mesh> mesh, const SpatialIndex& right, double radius,
           std::span<const Vec3> places);

  double radius() const noexcept { return radius_; }
  std::span<const Vec3> places() const noexcept { return places_; }
  double found_mean() const noexcept;

  /// At how many places another answer is given.
  std::size_t wrong_answers(Searcher& searcher, Decider decider) const;

 private:
  double radius_;
  std::span<const Vec3> places_;
  std::vector<std::vector<TriangleId>> answers_;
};

}  // namespace keepout::app
