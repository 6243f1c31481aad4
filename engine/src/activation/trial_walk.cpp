// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trial_walk.h"

namespace keepout {
namespace {

// Leaves whose screens are kept, a power of 2; a cycle in contact looks at a dozen.
constexpr std::size_t most_leaves = 256;
constexpr std::size_t most_waiting = 4096;
constexpr std::size_t most_put_off = 1024;

/// A bit for each; all leaves but one are full.
std::uint32_t lanes_used(const LeafBlock& leaf) noexcept {
  std::size_t count = LeafBlock::lanes;
  while (!leaf.is_used(count - 1)) --count;
  return (std::uint32_t{1} << count) - 1;
}

}  // namespace

TrialWalk::TrialWalk(const WideBvh& tree)
    : tree_(tree), leaves_(most_leaves), waiting_(most_waiting), put_off_(most_put_off) {}

void TrialWalk::begin(const Vec3& tip, double margin, double longest) noexcept {
  tip_ = float_tip(tip);
  reach_ = float_reach(margin, longest, tip, tree_.coordinate_error());
  is_long_ = longest > margin;
  if (++cycle_ == 0) {  // the counter went round: forget the leaves of cycles long gone
    for (Leaf& its : leaves_) its.cycle = 0;
    cycle_ = 1;
  }
}

TrialWalk::Leaf& TrialWalk::leaf(std::uint32_t number) noexcept {
  Leaf& its = leaves_[number % most_leaves];
  if (its.number == number && its.cycle == cycle_) return its;
  ++looks_;
  const LeafBlock& block = tree_.leaves()[number];
  its.number = number;
  its.cycle = cycle_;
  its.note.fill(no_note);
  its.used = lanes_used(block);
  look(block, tip_, reach_, its.screen);
  return its;
}

/// Has a leaf brought nearer that is likely to be looked at soon, and has not been in this cycle.
void TrialWalk::fetch(std::uint32_t number) const noexcept {
  const Leaf& its = leaves_[number % most_leaves];
  if (its.number == number && its.cycle == cycle_) return;
  constexpr std::size_t line = 64;
  const char* block = reinterpret_cast<const char*>(&tree_.leaves()[number]);
  for (std::size_t at = 0; at < sizeof(LeafBlock); at += line) __builtin_prefetch(block + at);
}

/// At suspects that may be met no later than `latest`.
void TrialWalk::look_closer(PutOff& its, double latest) noexcept {
  const LeafBlock& block = tree_.leaves()[its.leaf];
  const auto until = static_cast<float>(latest * (1.0 + 1e-6));  // not before it, when rounded
  if (its.looks_left-- == closer_looks) {
    suspect_sharply(block, tip_, motion_.data(), reach_, until, leaf(its.leaf).screen,
                    its.suspects);
  } else {
    suspect_later(block, tip_, motion_.data(), reach_, until, its.suspects);
  }
}

/// False where there is no room.
bool TrialWalk::wait(float time, std::uint32_t what) noexcept {
  if (waiting_size_ == waiting_.size()) return false;
  waiting_[waiting_size_++] = {time, what};
  std::push_heap(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_size_),
                 [](const Waiting& a, const Waiting& b) { return a.time > b.time; });
  return true;
}

TrialWalk::Waiting TrialWalk::next() noexcept {
  std::pop_heap(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_size_),
                [](const Waiting& a, const Waiting& b) { return a.time > b.time; });
  return waiting_[--waiting_size_];
}

std::uint32_t TrialWalk::PutOff::earliest() const noexcept {
  auto found = static_cast<std::uint32_t>(std::countr_zero(suspects.mask));
  for (std::uint32_t lanes = suspects.mask; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
    if (suspects.time[lane] < suspects.time[found]) found = lane;
  }
  return found;
}

}  // namespace keepout
