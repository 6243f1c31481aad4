// SPDX-License-Identifier: BSD-3-Clause
#include "tree_traversal.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace keepout {
namespace {

constexpr std::size_t most_waiting = 4096;
constexpr std::size_t most_deferred = 1024;  // below suspects_bit, like the numbers of nodes

// Newton steps each time that suspects are sharpened.
constexpr int steps_of_sharpening = 2;

/// Returns true if more than `count` bits are set. Some of the targets have no instruction to count
/// bits.
bool are_more(std::uint32_t bits, int count) noexcept {
  for (; count > 0; --count) bits &= bits - 1;
  return bits != 0;
}

}  // namespace

TreeTraversal::TreeTraversal(const WideBvh::Tree& tree, Budget& budget)
    : tree_(tree),
      budget_(budget),
      leaves_(most_leaves),
      waiting_(most_waiting),
      deferred_(most_deferred) {}

bool TreeTraversal::begin(const Start& start) noexcept {
  locate(start);
  region_is_empty_ = cache_.holds_nothing(start.region);
  if (region_is_empty_) return true;
  tip_ = start.tip;
  longest_ = start.longest;
  float_tip_ = float_tip(tip_ - tree_.frame().origin);
  begin_again(start.level);
  return true;
}

void TreeTraversal::begin_again(double level) noexcept {
  const LeafFrame& frame = tree_.frame();
  levels_ = float_levels(level, longest_, tip_ - frame.origin, frame.error);
  is_long_ = longest_ > level;
  if (++generation_ == 0) {  // the counter overflowed, so all leaves count as new
    for (SeenLeaf& each : leaves_) each.filled_in = 0;
    generation_ = 1;
  }
}

/// Makes the traversal cache cover the region of the cycle. Adds a padding if it is likely to serve
/// later cycles: if it is longer than the motions, and the tip moves without a jump. The padding
/// adapts to the number of boxes of a cover. Its factors were tuned by experiment:
///
///     Boxes left unopened   times 0.25, and a new cover.
///     No boxes              times 2, plus one motion.
///     Fewer than 12         times 1.5, plus a tenth of a motion.
///     12 to 24              unchanged.
///     More than 24          times 0.7.
///
/// Steps are the same for every padding, unless the work budget ends first.
void TreeTraversal::locate(const Start& start) noexcept {
  if (cache_.covers(start.region)) return;
  const double longest = start.longest;
  // After a jump, as between the states of a planner, a larger cover would not serve the next
  // cycle.
  const bool serves_more = padding_ > longest && cache_.is_near(start.region);
  const auto cover = [&](double padding) {
    cache_.cover(tree_, {start.region.center, start.region.radius + padding});
  };
  cover(serves_more ? padding_ : 0.0);
  if (serves_more && !cache_.is_opened()) {
    // Every later cycle would have to open the large boxes.
    padding_ *= 0.25;
    cover(padding_ > longest ? padding_ : 0.0);
    return;
  }
  if (padding_ > longest && !serves_more) return;  // this padding was not tried
  constexpr std::size_t few = 12;
  constexpr std::size_t many = 24;
  if (cache_.size() == 0) {
    padding_ = 2.0 * padding_ + longest;
  } else if (cache_.size() < few) {
    padding_ = 1.5 * padding_ + 0.1 * longest;
  } else if (cache_.size() > many) {
    padding_ *= 0.7;
  }
}

bool TreeTraversal::traversal(const Vec3& motion, TriangleVisitor& visitor) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    motion_[axis] = static_cast<float>(motion[static_cast<Eigen::Index>(axis)]);
  }
  visitor_ = &visitor;
  latest_ = never;
  begun_size_ = 0;
  waiting_size_ = 0;
  deferred_size_ = 0;
  meets_nothing_ = true;
  for (std::size_t i = 0; i < cache_.blocks().size(); ++i) {
    enter(cache_.blocks()[i], [&]() -> const CylinderBlock& { return cache_.cylinders(tree_, i); });
  }
  while (!budget_.is_spent()) {
    if (begun_size_ > 0) {
      descend(begun_[--begun_size_]);
      continue;
    }
    if (waiting_size_ == 0) return meets_nothing_;
    if (comes_too_late(waiting_[0].time)) return false;
    const std::uint32_t what = pop_earliest().what;
    // Leaf numbers have 31 bits, so suspects_bit has its meaning only without leaf_bit.
    if ((what & NodeBlock::leaf_bit) == 0 && (what & suspects_bit) != 0) {
      resume(what & ~suspects_bit);
    } else {
      descend(what);
    }
  }
  return false;
}

/// Opens a box: inspects a leaf or enters a node.
void TreeTraversal::descend(std::uint32_t box) noexcept {
  if ((box & NodeBlock::leaf_bit) != 0) {
    inspect(box & ~NodeBlock::leaf_bit);
  } else {
    enter(tree_.nodes()[box], [&]() -> const CylinderBlock& { return tree_.cylinders()[box]; });
  }
}

/// Finds the boxes of a node that the motion reaches, and their times. Opens each box now or lets
/// it wait. `cylinders()` returns the cylinders of the boxes; it is called only if needed.
template <class Cylinders>
void TreeTraversal::enter(const NodeBlock& node, Cylinders&& cylinders) noexcept {
  BoxEntries entries;
  budget_.spend(work::boxes);
  enter_boxes(node, float_tip_, motion_.data(), levels_, entries);
  // Cylinders cost less than opening more boxes than this.
  if (are_more(entries.reached, is_long_ ? 1 : 4)) {
    budget_.spend(work::cylinders);
    enter_cylinders(cylinders(), float_tip_, motion_.data(), levels_, entries);
  }
  for (std::uint32_t reached = entries.reached; reached != 0; reached &= reached - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(reached));
    const std::uint32_t child = node.child[lane];
    if (!node.is_used(lane)) break;  // child 0 is the root, so the traversal would never end
    if ((child & NodeBlock::leaf_bit) != 0) prefetch_leaf(child & ~NodeBlock::leaf_bit);
    const float time = entries.time[lane];
    // If the motion begins in a box, the tip may be too close already. So the box is opened now,
    // even if there is an early contact. So is a box that cannot wait because the heap is full.
    if (time > 0.0f) {
      if (comes_too_late(time)) {
        meets_nothing_ = false;
        continue;
      }
      if (wait(time, child)) continue;
    }
    begun_[begun_size_++] = child;
  }
}

/// Finds the suspects of a leaf, and visits or defers them.
void TreeTraversal::inspect(std::uint32_t number) noexcept {
  SeenLeaf& seen = filled_leaf(number);
  Deferred& found = deferred_[deferred_size_];
  found.leaf_number = number;
  budget_.spend(work::suspects);
  std::uint32_t begun = find_suspects(seen.filter, motion_.data(), until(), found.suspects);
  if ((begun | found.suspects.mask) == 0) return;
  meets_nothing_ = false;

  // Suspects at time 0 or before are visited now, because the tip may be too close already. If the
  // memory for deferred suspects is full, all are visited now.
  if (deferred_size_ + 1 == deferred_.size()) begun |= std::exchange(found.suspects.mask, 0u);
  for (; begun != 0; begun &= begun - 1) {
    visit(seen, static_cast<std::uint32_t>(std::countr_zero(begun)));
  }
  if (found.suspects.mask == 0) return;
  found.sharpenings_left = is_long_ ? most_sharpenings : are_more(found.suspects.mask, 2) ? 1 : 0;
  const auto deferred = static_cast<std::uint32_t>(deferred_size_++);
  const float time = found.suspects.time[found.suspects.earliest];
  if (!wait(time, deferred | suspects_bit)) resume(deferred);
}

/// Visits suspects of a leaf, the earliest first, until a waiting one is earlier.
void TreeTraversal::resume(std::uint32_t number) noexcept {
  Deferred& deferred = deferred_[number];
  Suspects& suspects = deferred.suspects;
  while (suspects.mask != 0) {
    if (deferred.sharpenings_left > 0) sharpen(deferred);
    if (suspects.mask == 0) return;
    const std::uint32_t lane = suspects.earliest;
    const float time = suspects.time[lane];
    if (comes_too_late(time)) return;
    if (waiting_size_ > 0 && waiting_[0].time < time && wait(time, number | suspects_bit)) return;
    if (deferred.sharpenings_left > 0) continue;
    suspects.remove(lane);
    visit(filled_leaf(deferred.leaf_number), lane);
  }
}

/// Searches for better proofs for the suspects that may be met before `latest_`.
void TreeTraversal::sharpen(Deferred& deferred) noexcept {
  const LeafBlock& block = tree_.leaves()[deferred.leaf_number];
  budget_.spend(work::sharpening);
  --deferred.sharpenings_left;
  sharpen_suspects(block, float_tip_, motion_.data(), levels_, until(), steps_of_sharpening,
                   filled_leaf(deferred.leaf_number).filter, deferred.suspects);
}

/// Shows a triangle to the visitor.
void TreeTraversal::visit(SeenLeaf& seen, std::uint32_t lane) noexcept {
  std::uint32_t& note = seen.note[lane];
  const TriangleId triangle = tree_.leaves()[seen.number].triangle(lane);
  if (note != no_note) {
    latest_ = visitor_->visit(triangle, note, nullptr);
  } else {
    const Triangle relative = corners(seen.number, lane);
    latest_ = visitor_->visit(triangle, note, &relative);
  }
}

/// Returns the corners of a triangle relative to the tip, in lexicographic order.
Triangle TreeTraversal::corners(std::uint32_t number, std::size_t lane) const noexcept {
  const LeafBlock& block = tree_.leaves()[number];
  if (!tree_.frame().is_exact()) {
    return ordered_relative(tree_.mesh().triangle(block.triangle(lane)), tip_);
  }
  Triangle corners;
  for (std::size_t c = 0; c < 3; ++c) {
    corners[c] =
        Vec3(block.corner[c][0][lane], block.corner[c][1][lane], block.corner[c][2][lane]) - tip_;
  }
  return corners;
}

/// Returns a leaf with its filter and notes. The first call in a generation fills them, and spends
/// work. They replace another leaf, whose notes are lost.
TreeTraversal::SeenLeaf& TreeTraversal::filled_leaf(std::uint32_t number) noexcept {
  SeenLeaf& seen = leaves_[number % most_leaves];
  if (seen.number == number && seen.filled_in == generation_) return seen;
  budget_.spend(work::leaf);
  const LeafBlock& block = tree_.leaves()[number];
  seen.number = number;
  seen.filled_in = generation_;
  seen.note.fill(no_note);
  fill_filter(block, float_tip_, levels_, seen.filter);
  return seen;
}

/// Prefetches a leaf that is likely to be needed soon, unless it is filled.
void TreeTraversal::prefetch_leaf(std::uint32_t number) const noexcept {
  const SeenLeaf& seen = leaves_[number % most_leaves];
  if (seen.number != number || seen.filled_in != generation_) prefetch(tree_.leaves()[number]);
}

/// Adds a box or suspects to the heap. Returns false if the heap is full.
bool TreeTraversal::wait(float time, std::uint32_t what) noexcept {
  if (waiting_size_ == waiting_.size()) return false;
  waiting_[waiting_size_++] = {time, what};
  std::push_heap(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_size_),
                 is_later);
  return true;
}

/// Removes the earliest entry from the heap and returns it. Precondition: the heap is not empty.
TreeTraversal::Waiting TreeTraversal::pop_earliest() noexcept {
  std::pop_heap(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_size_),
                is_later);
  return waiting_[--waiting_size_];
}

}  // namespace keepout
