// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "keepout/activation/paper.h"
#include "keepout/index/wide_bvh.h"
#include "leaf_edges.h"
#include "paper_screen.h"
#include "sort_by_number.h"

namespace keepout {

/// The paper's rule on a tree of its own: query and conditions in one look at each leaf. Floats
/// tell on which corner or side a closest point lies, and whether the neighbour shares it, where
/// they are sure; then the plane follows from that corner or side alone, in double, by the terms of
/// PaperRule. Where they are not, PaperRule is asked about the triangle. So the planes are its own,
/// bit for bit and in the same order, whatever the tree and the width of lanes.
///
/// Where only the planes in the way are needed, idle ones are not even made. A solver that skips
/// idle rows comes to the same motion without them: as long as standing still is allowed, all that
/// it looks at lies in idle_ball. Otherwise it gets them all.
class PaperSearch final : public Activation {
 public:
  /// `tree` must outlive this. After a refit of it every start is refused, as over_capacity: what
  /// is known of edges and normals is another mesh's.
  PaperSearch(const PaperRule& rule, const WideBvh& tree);

  void reserve(std::size_t triangles) override;
  bool searches() const noexcept override { return true; }
  std::size_t triangles(const Surroundings&) const noexcept override { return triangles_; }
  Opening start(const Surroundings& around, HalfSpaceBuffer& planes) noexcept override;
  Judgement judge(const Surroundings& around, const Vec3& trial,
                  HalfSpaceBuffer& planes) noexcept override;

 private:
  void walk(const PaperQuery& query) noexcept;
  bool find(const Surroundings& around, NeededPlanes needed, HalfSpaceBuffer& planes) noexcept;
  void take_in(const PaperAnswers& answers, const Surroundings& around) noexcept;
  void ask_rule(TriangleId t, const Surroundings& around) noexcept;
  HalfSpace plane_of(const Numbered& found, const Surroundings& around) const noexcept;

  PaperRule rule_;
  const WideBvh& tree_;
  std::uint64_t generation_;      // of the tree that is known here
  std::vector<LeafEdges> edges_;  // of each leaf
  std::vector<Vec3> normals_;     // of each triangle

  // Of this cycle.
  std::size_t capacity_ = 0;
  std::size_t triangles_ = 0;  // in the ball
  NeededPlanes handed_over_ = NeededPlanes::all;
  std::vector<std::uint32_t> leaves_;  // that the ball touches
  std::size_t leaf_count_ = 0;
  std::unique_ptr<PaperRest> rest_;
  std::unique_ptr<PaperAnswers> answers_;
  std::vector<Numbered> found_;  // triangles with a plane, and how it comes about
  std::vector<Numbered> sorted_;
  std::size_t found_count_ = 0;
  std::vector<HalfSpace> answered_;  // planes that the plain rule was asked for
  std::size_t answered_count_ = 0;
};

}  // namespace keepout
