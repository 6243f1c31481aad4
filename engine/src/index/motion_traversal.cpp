// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/motion_traversal.h"

#include <algorithm>
#include <span>
#include <vector>

#include "keepout/index/query.h"

namespace keepout {
namespace {

/// Visits all hits in the region, whatever the motion is: for an index without its own traversal.
class TraversalOfHits final : public MotionTraversal {
 public:
  explicit TraversalOfHits(Neighborhood& neighborhood)
      : neighborhood_(neighborhood), notes_(neighborhood.room()) {}

  bool begin(const Start& start) noexcept override {
    tip_ = start.tip;
    if (!neighborhood_.gather(start.region)) return false;
    begin_again(start.level);
    return true;
  }

  void begin_again(double) noexcept override {
    std::fill_n(notes_.begin(), neighborhood_.hits().size(), no_note);
  }

  bool region_is_empty() const noexcept override { return neighborhood_.hits().empty(); }

  bool traversal(const Vec3&, TriangleVisitor& visitor) noexcept override {
    const std::span<const Hit> hits = neighborhood_.hits();
    for (std::size_t i = 0; i < hits.size() && !neighborhood_.budget().is_spent(); ++i) {
      const TriangleId t = hits[i].triangle;
      if (notes_[i] == no_note) {
        const Triangle corners = ordered_relative(neighborhood_.mesh().triangle(t), tip_);
        visitor.visit(t, notes_[i], &corners);
      } else {
        visitor.visit(t, notes_[i], nullptr);
      }
    }
    return false;
  }

  std::size_t room() const noexcept override { return neighborhood_.room(); }

 private:
  Neighborhood& neighborhood_;
  Vec3 tip_ = Vec3::Zero();
  std::vector<std::uint32_t> notes_;  // of each hit
};

}  // namespace

std::unique_ptr<MotionTraversal> make_motion_traversal(Neighborhood& neighborhood) {
  if (auto own = neighborhood.index().traverse_along_motions(neighborhood.budget())) return own;
  return std::make_unique<TraversalOfHits>(neighborhood);
}

}  // namespace keepout
