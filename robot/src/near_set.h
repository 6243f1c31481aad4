// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gap.h"
#include "keepout/index/query.h"
#include "near_blocks.h"

namespace keepout {

/// A triangle near a body in a cycle, and the gap between them.
struct NearTriangle {
  TriangleId id;
  double at_least;           // a lower bound of its distance at the start of the cycle [length]
  const Triangle* corners;   // their positions; valid until triangles are gathered again
  Vec3* normal;              // of the last plane between it and the core; zero if there is no plane
  bool is_measured = false;  // at_start is known
  Gap at_start = {};         // at the start of the cycle
};

/// The triangles near one body, kept from cycle to cycle. While no point of the body has moved
/// farther than the padding of the search, no other triangle can limit the body. The engine, not
/// the index, decides which triangles are listed, so every index gives the same list.
///
/// A listing holds the triangles near the core in one cycle. It is extended on demand; triangles
/// listed before keep their place.
class NearSet {
 public:
  /// Makes an empty set for a body whose core is within `beyond` [length] of the segment of its
  /// first two points. Allocates memory for `capacity` triangles; no other function allocates.
  NearSet(std::size_t capacity, double beyond);

  /// Finds all triangles within `radius` of a core, and starts a listing. Returns false, with no
  /// triangle known, if there are too many triangles or the budget is spent. [length]
  [[nodiscard]] bool gather(Neighborhood& near, std::span<const Vec3> core, double radius,
                            Budget& budget) noexcept;

  /// Forgets all triangles, and empties the listing.
  void forget() noexcept {
    radius_ = -1.0;
    ids_.clear();
    listed_.clear();
  }

  /// Returns the distance from gathered_core() within which all triangles are known; below 0 if no
  /// triangle is known. [length]
  double radius() const noexcept { return radius_; }
  /// Returns the positions of the core's points when triangles were gathered. [length]
  std::span<const Vec3> gathered_core() const noexcept { return core_; }
  /// Returns the number of triangles.
  std::size_t size() const noexcept { return ids_.size(); }

  /// Starts a new listing, with the core at other positions. All listed triangles become invalid.
  void start_listing(std::span<const Vec3> core) noexcept;
  /// Lists the triangles that may be nearer than `distance` to the core at the start of the cycle,
  /// sorted by NearTriangle::at_least, then by number. Valid until the next listing. [length]
  std::span<NearTriangle> nearer_than(double distance, Budget& budget) noexcept;
  /// Measures the gap of a listed triangle, unless it is measured already.
  void measure(NearTriangle& triangle, Budget& budget) noexcept;

 private:
  NearScreen screen_within(double distance) const noexcept;

  std::size_t capacity_;
  double beyond_;
  double radius_ = -1.0;
  std::vector<Vec3> core_;
  double size_ = 0.0;  // the largest coordinate, from the core's first point [length]
  std::vector<TriangleId> ids_;
  std::vector<Triangle> corners_;
  std::vector<NearBlock> blocks_;  // the corners in single precision
  std::vector<Vec3> normals_;      // see NearTriangle::normal
  // The current listing.
  std::vector<Vec3> now_;     // the core's points
  Vec3 from_ = Vec3::Zero();  // the segment of the first two
  Vec3 to_ = Vec3::Zero();
  /// A triangle that is not listed yet.
  struct Found {
    double at_least;  // see NearTriangle [length]
    TriangleId id;
    std::uint32_t number;  // in ids_

    bool operator<(const Found& o) const noexcept {
      return at_least < o.at_least || (at_least == o.at_least && id < o.id);
    }
  };
  std::vector<Found> found_;  // a temporary
  std::vector<NearTriangle> listed_;
  std::vector<std::uint64_t> listed_in_;  // of each triangle, the last listing that it is in
  std::uint64_t listing_ = 0;
  double listed_below_ = 0.0;  // all triangles that may be nearer are listed [length]
};

}  // namespace keepout
