// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "keepout/oracle/triangle_tree.h"

namespace keepout::oracle {

/// The triangles around a moving place, side by side in memory: a tip that moves a little at a time
/// rarely needs the tree. For one thread; it allocates when it fetches.
class Neighborhood {
 public:
  struct Neighbor {
    Bounds bounds;
    Triangle triangle;
    TriangleId id;
  };
  /// Some that are near each other, passed over at once where their bounds are out of the way.
  struct Group {
    Bounds bounds;
    std::span<const Neighbor> neighbors;
  };

  explicit Neighborhood(std::shared_ptr<const TriangleTree> tree);

  /// At least each triangle whose bounds overlap the box, once. The order of any two of them is
  /// always the same. Valid until the next call.
  std::span<const Group> around(const Bounds& box) {
    if (!region_.contains(box)) fetch(box);
    return groups_;
  }

  std::size_t fetches() const noexcept { return fetches_; }

 private:
  void fetch(const Bounds& box);

  std::shared_ptr<const TriangleTree> tree_;
  Bounds region_;        // neighbors_ are all that overlap it
  double margin_ = 4.0;  // of the region around the box, in sizes of the box
  std::vector<TriangleId> found_;
  std::vector<Neighbor> neighbors_;  // in the order of the tree, so those close by are near
  std::vector<Group> groups_;
  std::size_t fetches_ = 0;
};

}  // namespace keepout::oracle
