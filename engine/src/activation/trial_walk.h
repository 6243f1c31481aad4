// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "box_screen.h"
#include "frontier.h"
#include "leaf_screen.h"

namespace keepout {

/// Whether more than so many bits are set. Not every processor that this is compiled for has
/// an instruction that counts them.
inline bool are_more(std::uint32_t bits, int count) noexcept {
  for (; count > 0; --count) bits &= bits - 1;
  return bits != 0;
}

/// The way through a tree along one trial motion after another, from a tip that stays where it is:
/// to the triangles that a trial is not sure to keep clear of, the earliest first. Nothing but the
/// time it takes depends on what it remembers.
class TrialWalk {
 public:
  /// A leaf as it is seen from the tip.
  struct Leaf {
    LeafScreen screen;
    std::array<std::uint32_t, LeafBlock::lanes> note;  // the caller's, of each triangle
    std::uint32_t number = 0;
    std::uint32_t cycle = 0;  // that it was looked at in; 0: none yet
    std::uint32_t used = 0;   // a bit for each lane
  };
  static constexpr std::uint32_t no_note = ~std::uint32_t{0};

  /// `tree` must outlive this.
  explicit TrialWalk(const WideBvh& tree);

  /// From here on trials start at the tip, none is longer than `longest`, and `margin` is to be
  /// kept. Nothing is known of any triangle.
  void begin(const Vec3& tip, double margin, double longest) noexcept;

  /// Calls visit(leaf, lane) for the triangles below the frontier that the trial is not sure to
  /// keep clear of; none that it meets after `latest`, which visits may lower. The earliest come
  /// first, but for those that it may meet as it begins, and as far as there is room to put things
  /// off.
  ///
  /// True if there was nothing to visit whatever the time: the trial keeps clear of all, and so
  /// does any other that ends within `alike` times `longest` of it.
  template <class Visit>
  bool run(Frontier& frontier, const Vec3& trial, const double& latest, Visit&& visit) noexcept;
  static constexpr double alike = 1e-7;

  /// Of leaves, since `restart_counting`.
  std::size_t looks() const noexcept { return looks_; }
  void restart_counting() noexcept { looks_ = 0; }

  /// How often a cycle may look at a leaf: some milliseconds. Beyond it `run` leaves off.
  static constexpr std::size_t most_looks = std::size_t{1} << 17;

 private:
  /// Something that the trial may meet at some time.
  struct Waiting {
    float time;
    std::uint32_t what;  // as NodeBlock::child, or a number in put_off_ with bit `suspects`
  };
  static constexpr std::uint32_t suspects = std::uint32_t{1} << 30;

  /// How often suspects are looked at more closely before they are visited, where motions are long:
  /// many that come late turn out not to be met, or not first. Where motions are short, once is
  /// enough, and only if they are many.
  static constexpr int closer_looks = 3;

  /// Suspects of a leaf that are still to be visited.
  struct PutOff {
    Suspects suspects;
    std::uint32_t leaf;
    int looks_left;

    std::uint32_t earliest() const noexcept;
  };

  void look_closer(PutOff& its, double latest) noexcept;
  bool wait(float time, std::uint32_t what) noexcept;
  Waiting next() noexcept;
  template <class Cylinders>
  void enter(const NodeBlock& node, Cylinders&& cylinders, double latest) noexcept;
  template <class Visit>
  void look_at(std::uint32_t leaf, double latest, Visit&& visit) noexcept;
  template <class Visit>
  void resume(std::uint32_t put_off, const double& latest, Visit&& visit) noexcept;
  Leaf& leaf(std::uint32_t number) noexcept;
  void fetch(std::uint32_t leaf) const noexcept;

  const WideBvh& tree_;

  // Of this cycle.
  FloatTip tip_{};
  FloatReach reach_{};
  bool is_long_ = false;  // motions lead far beyond the margin
  std::uint32_t cycle_ = 0;
  std::size_t looks_ = 0;
  std::vector<Leaf> leaves_;  // some that were looked at

  // Of this trial.
  std::array<float, 3> motion_{};
  std::array<std::uint32_t, 16 * NodeBlock::lanes> begun_{};  // boxes that it begins in
  std::size_t begun_size_ = 0;
  std::vector<Waiting> waiting_;  // a heap, the earliest first
  std::size_t waiting_size_ = 0;
  std::vector<PutOff> put_off_;
  std::size_t put_off_size_ = 0;
  bool meets_nothing_ = false;
};

template <class Visit>
bool TrialWalk::run(Frontier& frontier, const Vec3& trial, const double& latest,
                    Visit&& visit) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    motion_[axis] = static_cast<float>(trial[static_cast<Eigen::Index>(axis)]);
  }
  begun_size_ = 0;
  waiting_size_ = 0;
  put_off_size_ = 0;
  meets_nothing_ = true;
  const auto open = [&](std::uint32_t box) {
    if ((box & NodeBlock::leaf) != 0) {
      look_at(box & ~NodeBlock::leaf, latest, visit);
    } else {
      const auto cylinders = [&]() -> const CylinderBlock& { return tree_.cylinders()[box]; };
      enter(tree_.nodes()[box], cylinders, latest);
    }
  };
  for (std::size_t i = 0; i < frontier.blocks().size(); ++i) {
    const auto cylinders = [&]() -> const CylinderBlock& { return frontier.cylinders(tree_, i); };
    enter(frontier.blocks()[i], cylinders, latest);
  }
  while (looks_ <= most_looks) {
    if (begun_size_ > 0) {
      open(begun_[--begun_size_]);
      continue;
    }
    if (waiting_size_ == 0) return meets_nothing_;
    if (static_cast<double>(waiting_[0].time) > latest) return false;
    const std::uint32_t what = next().what;
    if ((what & NodeBlock::leaf) == 0 && (what & suspects) != 0) {
      resume(what & ~suspects, latest, visit);
    } else {
      open(what);
    }
  }
  return false;
}

/// Finds out which boxes of a node the trial reaches, and when. `cylinders()` are those beside
/// them, asked for where they are needed.
template <class Cylinders>
void TrialWalk::enter(const NodeBlock& node, Cylinders&& cylinders, double latest) noexcept {
  BoxEntries entries;
  enter_boxes(node, tip_, motion_.data(), reach_, entries);
  // To look closer is cheaper than to look into more boxes than this.
  if (are_more(entries.reached, is_long_ ? 1 : 4)) {
    enter_cylinders(cylinders(), tip_, motion_.data(), reach_, entries);
  }
  for (std::uint32_t reached = entries.reached; reached != 0; reached &= reached - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(reached));
    const std::uint32_t child = node.child[lane];
    if (child == 0) break;
    if ((child & NodeBlock::leaf) != 0) fetch(child & ~NodeBlock::leaf);
    const float time = entries.time[lane];
    // What the motion begins in it may meet before it begins: where the tip is too close already.
    if (time > 0.0f) {
      if (static_cast<double>(time) > latest) {
        meets_nothing_ = false;
        continue;
      }
      if (wait(time, child)) continue;
    }
    begun_[begun_size_++] = child;
  }
}

template <class Visit>
void TrialWalk::look_at(std::uint32_t number, double latest, Visit&& visit) noexcept {
  Leaf& its = leaf(number);
  PutOff& found = put_off_[put_off_size_];
  found.leaf = number;
  suspect(its.screen, motion_.data(), found.suspects);
  std::uint32_t& mask = found.suspects.mask;
  mask &= its.used;
  if (mask == 0) return;
  meets_nothing_ = false;

  // What the motion may meet before it begins, where the tip is too close already, is visited now;
  // and all, where there is no room to put it off.
  const bool has_room = put_off_size_ + 1 < put_off_.size();
  std::uint32_t later = 0;
  for (std::uint32_t lanes = mask; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
    const float time = found.suspects.time[lane];
    if (time > 0.0f) {
      if (static_cast<double>(time) > latest) continue;
      if (has_room) {
        later |= std::uint32_t{1} << lane;
        continue;
      }
    }
    visit(its, lane);
  }
  mask = later;
  if (mask == 0) return;
  found.looks_left = is_long_ ? closer_looks : are_more(mask, 2) ? 1 : 0;
  const auto put_off = static_cast<std::uint32_t>(put_off_size_++);
  if (!wait(found.suspects.time[found.earliest()], put_off | suspects)) {
    resume(put_off, latest, visit);
  }
}

/// Visits suspects of a leaf for as long as they are the next.
template <class Visit>
void TrialWalk::resume(std::uint32_t put_off, const double& latest, Visit&& visit) noexcept {
  PutOff& its = put_off_[put_off];
  while (its.suspects.mask != 0) {
    if (its.looks_left > 0) look_closer(its, latest);
    if (its.suspects.mask == 0) return;
    const std::uint32_t lane = its.earliest();
    const float time = its.suspects.time[lane];
    if (static_cast<double>(time) > latest) return;
    if (waiting_size_ > 0 && waiting_[0].time < time && wait(time, put_off | suspects)) return;
    if (its.looks_left > 0) continue;
    its.suspects.mask &= ~(std::uint32_t{1} << lane);
    visit(leaf(its.leaf), lane);
  }
}

}  // namespace keepout
