// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include "../tree.h"
#include "filters.h"
#include "keepout/index/motion_traversal.h"
#include "traversal_cache.h"

namespace keepout {

/// The traversal of a WideBvh: through the boxes along a motion, to the triangles that it is not
/// proved to stay clear of, the earliest first, until the visitor has met one. Filters in single
/// precision leave out triangles that are surely clear. The traversal remembers boxes and proofs
/// from motion to motion and from cycle to cycle, which saves time; steps are the same without
/// them, unless the work budget ends first.
///
/// Its words, in the order in which a motion meets them:
///
///     traversal cache    the boxes at which the motions of some cycles begin, within a padded
///     region entries     when the motion enters the boxes of a node begun       boxes in which the
///     motion starts, opened at once waiting     boxes and deferred suspects that it may meet
///     later, the earliest first suspects    triangles of a leaf that it is not proved to stay
///     clear of deferred    suspects that are still to be visited sharpen     find better proofs,
///     which make suspects clear or later; delay: only later visit       show a triangle to the
///     visitor, whose number for it is the note
class TreeTraversal final : public MotionTraversal {
 public:
  /// Both must outlive this. Precondition: the tree is not refit.
  TreeTraversal(const WideBvh::Tree& tree, Budget& budget);

  bool begin(const Start& start) noexcept override;
  void begin_again(double level) noexcept override;
  bool region_is_empty() const noexcept override { return region_is_empty_; }
  bool traversal(const Vec3& motion, TriangleVisitor& visitor) noexcept override;
  std::size_t room() const noexcept override { return most_leaves * LeafBlock::lanes; }

  /// Returns the boxes at which the traversals of the last cycle began.
  const TraversalCache& cache() const noexcept { return cache_; }

 private:
  // The capacity for leaves with filters and notes, a power of 2; a cycle in contact needs a dozen.
  // A leaf takes the place of another whose number has the same remainder.
  static constexpr std::size_t most_leaves = 256;

  /// A leaf as it is seen from the tip.
  struct SeenLeaf {
    LeafFilter filter;
    std::array<std::uint32_t, LeafBlock::lanes> note;
    std::uint32_t number = 0;
    std::uint32_t filled_in = 0;  // generation in which it was last filled; 0: none yet
    std::uint32_t used = 0;       // a bit for each lane
  };

  /// A box or suspects that the motion may meet at some time.
  struct Waiting {
    float time;
    std::uint32_t what;  // as NodeBlock::child, or a number in deferred_ with suspects_bit
  };
  /// Orders a heap with the earliest on top.
  static constexpr auto is_later = [](const Waiting& a, const Waiting& b) {
    return a.time > b.time;
  };
  static constexpr std::uint32_t suspects_bit = std::uint32_t{1} << 30;

  /// How often suspects are sharpened before they are visited, if motions are long: many that come
  /// late turn out not to be met, or not first. If motions are short, one Newton step is enough,
  /// and only if there are many suspects.
  static constexpr int most_sharpenings = 3;

  /// Suspects of a leaf that are still to be visited.
  struct Deferred {
    Suspects suspects;
    std::uint32_t leaf_number;
    int sharpenings_left;

    std::uint32_t earliest() const noexcept;
  };

  void locate(const Start& start) noexcept;
  void descend(std::uint32_t box) noexcept;
  template <class Cylinders>
  void enter(const NodeBlock& node, Cylinders&& cylinders) noexcept;
  void inspect(std::uint32_t leaf_number) noexcept;
  void sharpen(Deferred& deferred) noexcept;
  void resume(std::uint32_t deferred) noexcept;
  void visit(SeenLeaf& leaf, std::uint32_t lane) noexcept;
  bool wait(float time, std::uint32_t what) noexcept;
  Waiting pop_earliest() noexcept;
  SeenLeaf& filled_leaf(std::uint32_t number) noexcept;
  void prefetch_leaf(std::uint32_t number) const noexcept;
  Triangle corners(std::uint32_t leaf_number, std::size_t lane) const noexcept;
  bool comes_too_late(float time) const noexcept { return static_cast<double>(time) > latest_; }

  const WideBvh::Tree& tree_;
  Budget& budget_;
  TraversalCache cache_;
  double padding_ = 0.0;  // covered beyond the region, for cycles to come [length]

  // Of this cycle.
  Vec3 tip_ = Vec3::Zero();
  double longest_ = 0.0;
  FloatTip float_tip_{};
  FloatLevels levels_{};
  bool region_is_empty_ = false;
  bool is_long_ = false;          // motions may be longer than the level
  std::uint32_t generation_ = 0;  // counts beginnings; leaves filled in earlier ones are forgotten
  std::vector<SeenLeaf> leaves_;

  // Of this motion.
  TriangleVisitor* visitor_ = nullptr;
  double latest_ = 0.0;  // contacts after this fraction of the motion do not matter
  std::array<float, 3> motion_{};
  // Boxes that it begins in, to be opened now, the last one first: those of the traversal cache,
  // and fifteen more a level.
  std::array<std::uint32_t, 16 * NodeBlock::lanes> begun_{};
  static_assert(std::tuple_size_v<decltype(begun_)> >=
                TraversalCache::most_boxes + (NodeBlock::lanes - 1) * WideBvh::most_levels);
  std::size_t begun_size_ = 0;
  std::vector<Waiting> waiting_;  // a heap, the earliest first
  std::size_t waiting_size_ = 0;
  std::vector<Deferred> deferred_;  // the place after the last one is for inspect() to write in
  std::size_t deferred_size_ = 0;
  bool meets_nothing_ = false;
};

}  // namespace keepout
