// SPDX-License-Identifier: BSD-3-Clause
#include "tree_walk.h"

#include <algorithm>
#include <bit>

namespace keepout {
namespace {

// Leaves whose filters are kept, a power of 2; a cycle in contact looks at a dozen.
constexpr std::size_t most_leaves = 256;
constexpr std::size_t most_waiting = 4096;
constexpr std::size_t most_deferred = 1024;

// In looks, about as long as each takes: see Budget.
constexpr std::size_t work_of_boxes = 1;
constexpr std::size_t work_of_cylinders = 2;
constexpr std::size_t work_of_leaf = 4;
constexpr std::size_t work_of_suspects = 1;
constexpr std::size_t work_of_closer_look = 4;

/// Whether more than so many bits are set. Not every processor that this is compiled for has
/// an instruction that counts them.
bool are_more(std::uint32_t bits, int count) noexcept {
  for (; count > 0; --count) bits &= bits - 1;
  return bits != 0;
}

/// A bit for each; all leaves but one are full.
std::uint32_t lanes_used(const LeafBlock& leaf) noexcept {
  std::size_t count = LeafBlock::lanes;
  while (!leaf.is_used(count - 1)) --count;
  return (std::uint32_t{1} << count) - 1;
}

}  // namespace

TreeWalk::TreeWalk(const WideBvh::Tree& tree, Budget& budget)
    : tree_(tree),
      budget_(budget),
      leaves_(most_leaves),
      waiting_(most_waiting),
      deferred_(most_deferred) {}

bool TreeWalk::begin(const Start& start) noexcept {
  locate(start);
  is_free_ = frontier_.is_free(start.region);
  if (is_free_) return true;
  tip_ = start.tip;
  longest_ = start.longest;
  float_tip_ = float_tip(tip_ - tree_.frame().origin);
  begin_again(start.level);
  return true;
}

void TreeWalk::begin_again(double level) noexcept {
  const LeafFrame& frame = tree_.frame();
  reach_ = float_reach(level, longest_, tip_ - frame.origin, frame.error);
  is_long_ = longest_ > level;
  if (++cycle_ == 0) {  // the counter went round: forget the leaves of cycles long gone
    for (Leaf& each : leaves_) each.cycle = 0;
    cycle_ = 1;
  }
}

/// Sees to it that the frontier covers all that the cycle may ask about. It reaches farther than it
/// must, for the cycles to come, as long as that leaves few boxes and cycles are short.
void TreeWalk::locate(const Start& start) noexcept {
  if (frontier_.covers(start.region)) return;
  const double motion = start.longest;
  // A planner's states have nothing to do with each other: more would serve none of them.
  const bool serves_more = padding_ > motion && frontier_.is_near(start.region);
  const auto gather = [&](double padding) {
    frontier_.gather(tree_, {start.region.center, start.region.radius + padding});
  };
  gather(serves_more ? padding_ : 0.0);
  if (serves_more && !frontier_.is_opened()) {
    // So far that large boxes are left over, which every cycle to come would have to look into.
    padding_ *= 0.25;
    gather(padding_ > motion ? padding_ : 0.0);
    return;
  }
  if (padding_ > motion && !serves_more) return;  // it tells nothing of reaching that far
  constexpr std::size_t few = 12;
  constexpr std::size_t many = 24;
  if (frontier_.size() == 0) {
    padding_ = 2.0 * padding_ + motion;
  } else if (frontier_.size() < few) {
    padding_ = 1.5 * padding_ + 0.1 * motion;
  } else if (frontier_.size() > many) {
    padding_ *= 0.7;
  }
}

bool TreeWalk::walk(const Vec3& motion, EncounterVisitor& visitor) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    motion_[axis] = static_cast<float>(motion[static_cast<Eigen::Index>(axis)]);
  }
  visitor_ = &visitor;
  latest_ = 2.0;  // after the motion's end
  begun_size_ = 0;
  waiting_size_ = 0;
  deferred_size_ = 0;
  meets_nothing_ = true;
  for (std::size_t i = 0; i < frontier_.blocks().size(); ++i) {
    enter(frontier_.blocks()[i],
          [&]() -> const CylinderBlock& { return frontier_.cylinders(tree_, i); });
  }
  while (!budget_.is_spent()) {
    if (begun_size_ > 0) {
      open(begun_[--begun_size_]);
      continue;
    }
    if (waiting_size_ == 0) return meets_nothing_;
    if (comes_too_late(waiting_[0].time)) return false;
    const std::uint32_t what = next().what;
    if ((what & NodeBlock::leaf) == 0 && (what & suspects) != 0) {
      resume(what & ~suspects);
    } else {
      open(what);
    }
  }
  return false;
}

void TreeWalk::open(std::uint32_t box) noexcept {
  if ((box & NodeBlock::leaf) != 0) {
    look_at(box & ~NodeBlock::leaf);
  } else {
    enter(tree_.nodes()[box], [&]() -> const CylinderBlock& { return tree_.cylinders()[box]; });
  }
}

/// Finds out which boxes of a node the motion reaches, and when. `cylinders()` are those beside
/// them, asked for where they are needed.
template <class Cylinders>
void TreeWalk::enter(const NodeBlock& node, Cylinders&& cylinders) noexcept {
  BoxEntries entries;
  budget_.spend(work_of_boxes);
  enter_boxes(node, float_tip_, motion_.data(), reach_, entries);
  // To look closer is cheaper than to look into more boxes than this.
  if (are_more(entries.reached, is_long_ ? 1 : 4)) {
    budget_.spend(work_of_cylinders);
    enter_cylinders(cylinders(), float_tip_, motion_.data(), reach_, entries);
  }
  for (std::uint32_t reached = entries.reached; reached != 0; reached &= reached - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(reached));
    const std::uint32_t child = node.child[lane];
    if (child == 0) break;
    if ((child & NodeBlock::leaf) != 0) fetch(child & ~NodeBlock::leaf);
    const float time = entries.time[lane];
    // What the motion begins in it may meet before it begins: where the tip is too close already.
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

void TreeWalk::look_at(std::uint32_t number) noexcept {
  Leaf& seen = leaf(number);
  Deferred& found = deferred_[deferred_size_];
  found.leaf = number;
  budget_.spend(work_of_suspects);
  find_suspects(seen.filter, motion_.data(), found.suspects);
  std::uint32_t& mask = found.suspects.mask;
  mask &= seen.used;
  if (mask == 0) return;
  meets_nothing_ = false;

  // What the motion may meet before it begins, where the tip is too close already, is visited now;
  // and all, where there is no room to defer it.
  const bool has_room = deferred_size_ + 1 < deferred_.size();
  std::uint32_t later = 0;
  for (std::uint32_t lanes = mask; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
    const float time = found.suspects.time[lane];
    if (time > 0.0f) {
      if (comes_too_late(time)) continue;
      if (has_room) {
        later |= std::uint32_t{1} << lane;
        continue;
      }
    }
    visit(seen, lane);
  }
  mask = later;
  if (mask == 0) return;
  found.looks_left = is_long_ ? closer_looks : are_more(mask, 2) ? 1 : 0;
  const auto deferred = static_cast<std::uint32_t>(deferred_size_++);
  if (!wait(found.suspects.time[found.earliest()], deferred | suspects)) resume(deferred);
}

/// Visits suspects of a leaf for as long as they are the next.
void TreeWalk::resume(std::uint32_t number) noexcept {
  Deferred& deferred = deferred_[number];
  while (deferred.suspects.mask != 0) {
    if (deferred.looks_left > 0) look_closer(deferred);
    if (deferred.suspects.mask == 0) return;
    const std::uint32_t lane = deferred.earliest();
    const float time = deferred.suspects.time[lane];
    if (comes_too_late(time)) return;
    if (waiting_size_ > 0 && waiting_[0].time < time && wait(time, number | suspects)) return;
    if (deferred.looks_left > 0) continue;
    deferred.suspects.mask &= ~(std::uint32_t{1} << lane);
    visit(leaf(deferred.leaf), lane);
  }
}

/// At suspects that may be met before it is too late.
void TreeWalk::look_closer(Deferred& deferred) noexcept {
  const LeafBlock& block = tree_.leaves()[deferred.leaf];
  const auto until = static_cast<float>(latest_ * (1.0 + 1e-6));  // not before it, when rounded
  budget_.spend(work_of_closer_look);
  if (deferred.looks_left-- == closer_looks) {
    refine_suspects(block, float_tip_, motion_.data(), reach_, until, leaf(deferred.leaf).filter,
                    deferred.suspects);
  } else {
    delay_suspects(block, float_tip_, motion_.data(), reach_, until, deferred.suspects);
  }
}

void TreeWalk::visit(Leaf& seen, std::uint32_t lane) noexcept {
  std::uint32_t& note = seen.note[lane];
  const TriangleId triangle = tree_.leaves()[seen.number].triangle(lane);
  if (note != Encounter::no_note) {
    latest_ = visitor_->visit({triangle, note, nullptr});
  } else {
    const Triangle relative = corners(seen.number, lane);
    latest_ = visitor_->visit({triangle, note, &relative});
  }
}

/// Relative to the tip, in lexicographic order.
Triangle TreeWalk::corners(std::uint32_t number, std::size_t lane) const noexcept {
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

TreeWalk::Leaf& TreeWalk::leaf(std::uint32_t number) noexcept {
  Leaf& seen = leaves_[number % most_leaves];
  if (seen.number == number && seen.cycle == cycle_) return seen;
  budget_.spend(work_of_leaf);
  const LeafBlock& block = tree_.leaves()[number];
  seen.number = number;
  seen.cycle = cycle_;
  seen.note.fill(Encounter::no_note);
  seen.used = lanes_used(block);
  look(block, float_tip_, reach_, seen.filter);
  return seen;
}

/// Has a leaf brought nearer that is likely to be looked at soon, and has not been in this cycle.
void TreeWalk::fetch(std::uint32_t number) const noexcept {
  const Leaf& seen = leaves_[number % most_leaves];
  if (seen.number == number && seen.cycle == cycle_) return;
  constexpr std::size_t line = 64;
  const char* block = reinterpret_cast<const char*>(&tree_.leaves()[number]);
  for (std::size_t at = 0; at < sizeof(LeafBlock); at += line) __builtin_prefetch(block + at);
}

/// False where there is no room.
bool TreeWalk::wait(float time, std::uint32_t what) noexcept {
  if (waiting_size_ == waiting_.size()) return false;
  waiting_[waiting_size_++] = {time, what};
  std::push_heap(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_size_),
                 [](const Waiting& a, const Waiting& b) { return a.time > b.time; });
  return true;
}

TreeWalk::Waiting TreeWalk::next() noexcept {
  std::pop_heap(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_size_),
                [](const Waiting& a, const Waiting& b) { return a.time > b.time; });
  return waiting_[--waiting_size_];
}

std::uint32_t TreeWalk::Deferred::earliest() const noexcept {
  auto found = static_cast<std::uint32_t>(std::countr_zero(suspects.mask));
  for (std::uint32_t lanes = suspects.mask; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
    if (suspects.time[lane] < suspects.time[found]) found = lane;
  }
  return found;
}

FloatTip float_tip(const Vec3& tip) noexcept {
  FloatTip split;
  for (int axis = 0; axis < 3; ++axis) {
    split.high[axis] = static_cast<float>(tip[axis]);
    split.low[axis] = static_cast<float>(tip[axis] - static_cast<double>(split.high[axis]));
  }
  return split;
}

FloatReach float_reach(double margin, double longest, const Vec3& tip, double error) noexcept {
  // What the two floats of the tip leave over, and what the leaf's coordinates are off by.
  const double fixed = 1e-13 * tip.lpNorm<1>() + 4.0 * error;
  const double slack = 2e-6 * margin + 3e-6 * longest + fixed;
  const double boxes = margin * (1.0 + 2e-6) + 4e-6 * longest + fixed;
  constexpr double up = 1.0 + 1e-6;
  return {static_cast<float>(margin * up), 1.5e-6f, static_cast<float>(slack * up),
          static_cast<float>(boxes * up)};
}

}  // namespace keepout
