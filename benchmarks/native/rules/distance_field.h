// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <shared_mutex>
#include <unordered_map>

#include "keepout/index/spatial_index.h"
#include "keepout/oracle/inside_test.h"

namespace keepout::peers {

/// Signed distances from a mesh at the corners of cubes, in a narrow band around the surface. Like
/// the leaves of OpenVDB (Museth, "VDB: high-resolution sparse volumes with dynamic topology", ACM
/// TOG 32, 2013), a block has 8 x 8 x 8 values in single precision. Only blocks within the band of
/// the surface have values. Elsewhere the distance is the band.
///
/// A distance is negative in the solid. It is exact at the corners, and cut off at the band. The
/// sign is that of the exact inside test; an open mesh has no solid. If the normals point inwards,
/// as of an airway with the tool inside, everything outside is solid.
///
/// Blocks are computed when they are first read, or by sample(). Values do not depend on the order.
/// Any number of threads may read.
class DistanceField {
  struct Tile;

 public:
  /// `cell`: edge of a cube. `band`: the largest distance that is stored. [mm] Throws Error unless
  /// the band is at least two cells.
  DistanceField(std::shared_ptr<const SpatialIndex> index, double cell, double band);

  double cell() const noexcept { return cell_; }
  bool is_signed() const noexcept { return inside_.closed(); }

  /// Returns a bound of the error of any interpolated distance within the band: sqrt(3) / 2 of a
  /// cell, and the rounding of the values. The distance changes by at most a length over that
  /// length. So the error is at most the mean of the distances to the corners with the weights of
  /// the interpolation. That mean is largest at the center of a cube. [mm]
  double error_bound() const noexcept { return 0.8660255 * cell_ + 1e-6 * band_; }

  /// Returns if the surface comes within the band of a block, which then has values.
  bool is_near(const std::array<int, 3>& block) const;

  /// Computes all blocks that overlap a box, and returns the memory of the blocks with values.
  /// [bytes]
  std::size_t sample(const Vec3& low, const Vec3& high);

  /// Returns the memory of all blocks of the mesh with values, without computing them. [bytes]
  std::size_t memory_of_all() const;

  /// An interpolated distance [mm] and its gradient.
  struct Value {
    double distance;
    Vec3 gradient;
  };

  /// Reads the field, and remembers the last blocks. Use one for each thread.
  class Reader {
   public:
    explicit Reader(std::shared_ptr<DistanceField> field) : field_(std::move(field)) {}
    const DistanceField& field() const noexcept { return *field_; }

    /// Returns the trilinear interpolation at a point. In a cube without values, the gradient is 0.
    Value operator()(const Vec3& point);

   private:
    struct Entry {
      std::array<int, 3> block{};
      const Tile* tile = nullptr;
    };
    double corner(int i, int j, int k);

    std::shared_ptr<DistanceField> field_;
    std::array<Entry, 8> last_;  // of the blocks that meet at a corner, each has a place of its own
  };

 private:
  static constexpr int side = 8;  // of a block, in cells
  using Values = std::array<float, side * side * side>;
  struct Tile {
    std::unique_ptr<Values> values;  // null: `background` everywhere
    float background;
  };

  const Tile& tile(const std::array<int, 3>& block);
  Tile make_tile(const std::array<int, 3>& block) const;
  void set_signs(const Vec3& low, Values& values) const;
  Vec3 place(const std::array<int, 3>& block) const;
  double distance(const Vec3& point) const;
  bool is_near(const Vec3& center, double edge) const;
  bool is_solid(const Vec3& point) const;

  std::shared_ptr<const SpatialIndex> index_;
  double cell_;
  double band_;
  oracle::InsideTest inside_;
  bool is_inside_out_;
  std::unordered_map<std::uint64_t, Tile> tiles_;
  std::shared_mutex tiles_mutex_;
};

}  // namespace keepout::peers
