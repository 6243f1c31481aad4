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

/// The traversal of a WideBvh: through the boxes along a motion, to the triangles that the motion
/// is not proved to stay clear of. The earliest come first, and the traversal ends when the visitor
/// has met one. Filters in single precision skip triangles that are surely clear. Boxes and proofs
/// are remembered from motion to motion and from cycle to cycle, which saves time. Steps are the
/// same without this memory, unless the work budget ends first.
///
/// The terms, in the order in which a motion meets them:
///
///     Traversal cache  the boxes at which motions begin, within a padded region.
///     Entries          the times when the motion enters the boxes of a node.
///     Begun            boxes in which the motion starts, opened at once.
///     Waiting          boxes and deferred suspects that may be met later, the earliest first.
///     Suspects         triangles of a leaf that the motion is not proved to stay clear of.
///     Deferred         suspects that are not visited yet.
///     Sharpen          find better proofs, which clear or delay suspects.
///     Visit            show a triangle to the visitor, whose number for it is the note.
class TreeTraversal final : public MotionTraversal {
 public:
  /// Both arguments must outlive this object. Precondition: the tree is not refit.
  TreeTraversal(const WideBvh::Tree& tree, Budget& budget);

  bool begin(const Start& start) noexcept override;
  void begin_again(double level) noexcept override;
  bool region_is_empty() const noexcept override { return region_is_empty_; }
  bool traversal(const Vec3& motion, TriangleVisitor& visitor) noexcept override;
  std::size_t room() const noexcept override { return most_leaves * LeafBlock::lanes; }

  /// Returns the boxes at which the traversals of the last cycle began.
  const TraversalCache& cache() const noexcept { return cache_; }

 private:
  // The capacity for leaves with filters and notes, a power of 2. A cycle in contact needs a dozen.
  // A leaf replaces another one whose number has the same remainder.
  static constexpr std::size_t most_leaves = 256;

  /// A leaf relative to the tip.
  struct SeenLeaf {
    LeafFilter filter;
    std::array<std::uint32_t, LeafBlock::lanes> note;
    std::uint32_t number = 0;
    std::uint32_t filled_in = 0;  // generation of the last filling; 0: not filled
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

  /// The number of times that suspects are sharpened before a visit if motions are long. Many late
  /// suspects are then not met, or not met first. If motions are short, once is enough, and only if
  /// there are many suspects.
  static constexpr int most_sharpenings = 2;

  /// Suspects of a leaf that are not visited yet.
  struct Deferred {
    Suspects suspects;
    std::uint32_t leaf_number;
    int sharpenings_left;
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
  /// Returns `latest_`, rounded to no earlier.
  float until() const noexcept { return static_cast<float>(latest_ * (1.0 + 1e-6)); }
  bool comes_too_late(float time) const noexcept { return static_cast<double>(time) > latest_; }

  const WideBvh::Tree& tree_;
  Budget& budget_;
  TraversalCache cache_;
  double padding_ = 0.0;  // of the cover beyond the region, for later cycles [length]

  // The state of the present cycle.
  Vec3 tip_ = Vec3::Zero();
  double longest_ = 0.0;
  FloatTip float_tip_{};
  FloatLevels levels_{};
  bool region_is_empty_ = false;
  bool is_long_ = false;          // motions may be longer than the level
  std::uint32_t generation_ = 0;  // counts calls of begin_again(); leaves filled in earlier
                                  // generations are invalid
  std::vector<SeenLeaf> leaves_;

  // The state of the present motion.
  TriangleVisitor* visitor_ = nullptr;
  double latest_ = 0.0;  // contacts after this fraction of the motion do not matter
  std::array<float, 3> motion_{};
  // Boxes in which the motion begins, to be opened now, the last one first. There are those of the
  // traversal cache, and fifteen more for each level.
  std::array<std::uint32_t, 16 * NodeBlock::lanes> begun_{};
  static_assert(std::tuple_size_v<decltype(begun_)> >=
                TraversalCache::most_boxes + (NodeBlock::lanes - 1) * WideBvh::most_levels);
  std::size_t begun_size_ = 0;
  std::vector<Waiting> waiting_;  // a heap, the earliest first
  std::size_t waiting_size_ = 0;
  std::vector<Deferred> deferred_;  // inspect() writes to the place after the last one
  std::size_t deferred_size_ = 0;
  bool meets_nothing_ = false;
};

}  // namespace keepout
