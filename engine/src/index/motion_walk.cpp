// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/motion_walk.h"

#include <algorithm>
#include <span>
#include <vector>

#include "keepout/index/query.h"

namespace keepout {
namespace {

/// Visits all hits in the region, whatever the motion: for indices that know of no motions.
class WalkOfHits final : public MotionWalk {
 public:
  explicit WalkOfHits(Neighborhood& near) : near_(near), notes_(near.room()) {}

  bool begin(const Start& start) noexcept override {
    tip_ = start.tip;
    if (!near_.gather(start.region)) return false;
    begin_again(start.level);
    return true;
  }

  void begin_again(double) noexcept override {
    std::fill_n(notes_.begin(), near_.hits().size(), Encounter::no_note);
  }

  bool is_free() const noexcept override { return near_.hits().empty(); }

  bool walk(const Vec3&, EncounterVisitor& visitor) noexcept override {
    const std::span<const Hit> hits = near_.hits();
    for (std::size_t i = 0; i < hits.size() && !near_.budget().is_spent(); ++i) {
      const TriangleId t = hits[i].triangle;
      if (notes_[i] == Encounter::no_note) {
        const Triangle corners = ordered_relative(near_.mesh().triangle(t), tip_);
        visitor.visit({t, notes_[i], &corners});
      } else {
        visitor.visit({t, notes_[i], nullptr});
      }
    }
    return false;
  }

  std::size_t room() const noexcept override { return near_.room(); }

 private:
  Neighborhood& near_;
  Vec3 tip_ = Vec3::Zero();
  std::vector<std::uint32_t> notes_;  // of each hit
};

}  // namespace

std::unique_ptr<MotionWalk> make_motion_walk(Neighborhood& near) {
  if (auto own = near.index().walk_along_motions(near.budget())) return own;
  return std::make_unique<WalkOfHits>(near);
}

}  // namespace keepout
