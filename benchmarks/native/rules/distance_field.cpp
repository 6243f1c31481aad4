// SPDX-License-Identifier: BSD-3-Clause
#include "distance_field.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "keepout/error.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/mesh/diagnostics.h"

namespace keepout::peers {
namespace {

using Block = std::array<int, 3>;

std::uint64_t key_of(const Block& b) {
  constexpr std::uint64_t mask = (1U << 21) - 1;
  const auto digits = [](int i) { return static_cast<std::uint64_t>(i) & mask; };
  return digits(b[0]) | digits(b[1]) << 21 | digits(b[2]) << 42;
}

}  // namespace

DistanceField::DistanceField(std::shared_ptr<const SpatialIndex> index, double cell, double band)
    : index_(std::move(index)),
      cell_(cell),
      band_(band),
      inside_(std::make_shared<const monitor::TriangleTree>(index_->shared_mesh())),
      is_inside_out_(examine(index_->mesh(), 0).is_inside_out()) {
  if (!(cell > 0.0 && band >= 2.0 * cell)) throw Error("the band must have two cells or more");
}

double DistanceField::distance(const Vec3& point) const {
  Budget unlimited;
  const TriangleId nearest = index_->nearest(point, unlimited);
  return closest_point(index_->mesh().triangle(nearest), point).distance;
}

bool DistanceField::is_solid(const Vec3& point) const {
  return inside_.closed() && *inside_.inside(point) != is_inside_out_;
}

Vec3 DistanceField::place(const Block& block) const {
  return Vec3(block[0], block[1], block[2]) * (side * cell_);
}

bool DistanceField::is_near(const Block& block) const {
  const double edge = side * cell_;
  return is_near(place(block) + Vec3::Constant(0.5 * edge), edge);
}

bool DistanceField::is_near(const Vec3& center, double edge) const {
  const double apart = distance(center);
  if (apart <= band_) return true;
  if (apart > band_ + 0.8660255 * edge) return false;
  if (edge <= cell_) return true;
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 way((octant & 1) - 0.5, (octant >> 1 & 1) - 0.5, (octant >> 2) - 0.5);
    if (is_near(center + 0.5 * edge * way, 0.5 * edge)) return true;
  }
  return false;
}

DistanceField::Tile DistanceField::make_tile(const Block& block) const {
  const Vec3 low = place(block);
  if (!is_near(block)) {
    const double far = is_solid(low) ? -band_ : band_;
    return {nullptr, static_cast<float>(far)};
  }
  auto values = std::make_unique<Values>();
  for (int i = 0, at = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      for (int k = 0; k < side; ++k, ++at) {
        (*values)[at] = static_cast<float>(distance(low + cell_ * Vec3(i, j, k)));
      }
    }
  }
  if (inside_.closed()) set_signs(low, *values);
  for (float& value : *values) {
    value = std::clamp(value, static_cast<float>(-band_), static_cast<float>(band_));
  }
  return {std::move(values), 0.0F};
}

/// Two places are on the same side if their distances are together larger than the way between
/// them. So one test serves all places that such ways connect.
void DistanceField::set_signs(const Vec3& low, Values& values) const {
  constexpr int all = side * side * side;
  std::array<bool, all> is_known{};
  std::vector<int> open;
  for (int first = 0; first < all; ++first) {
    if (is_known[first]) continue;
    const auto cube = [](int at) { return Block{at / (side * side), at / side % side, at % side}; };
    const Block f = cube(first);
    const bool solid = is_solid(low + cell_ * Vec3(f[0], f[1], f[2]));
    is_known[first] = true;
    open.assign(1, first);
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      const Block c = cube(at);
      const float here = values[at];
      for (int i = std::max(0, c[0] - 1); i < std::min(side, c[0] + 2); ++i) {
        for (int j = std::max(0, c[1] - 1); j < std::min(side, c[1] + 2); ++j) {
          for (int k = std::max(0, c[2] - 1); k < std::min(side, c[2] + 2); ++k) {
            const int other = (i * side + j) * side + k;
            const double way = cell_ * Vec3(i - c[0], j - c[1], k - c[2]).norm();
            if (is_known[other] || here + values[other] <= way * (1.0 + 1e-6)) continue;
            is_known[other] = true;
            open.push_back(other);
          }
        }
      }
      if (solid) values[at] = -values[at];
    }
  }
}

const DistanceField::Tile& DistanceField::tile(const Block& block) {
  const std::uint64_t key = key_of(block);
  {
    const std::shared_lock lock(tiles_mutex_);
    if (const auto found = tiles_.find(key); found != tiles_.end()) return found->second;
  }
  Tile made = make_tile(block);
  const std::unique_lock lock(tiles_mutex_);
  return tiles_.try_emplace(key, std::move(made)).first->second;  // references stay valid
}

std::size_t DistanceField::sample(const Vec3& low, const Vec3& high) {
  const Eigen::Array3i first = (low / (side * cell_)).array().floor().cast<int>();
  const Eigen::Array3i last = (high / (side * cell_)).array().floor().cast<int>();
  std::size_t stored = 0;
  for (int i = first[0]; i <= last[0]; ++i) {
    for (int j = first[1]; j <= last[1]; ++j) {
      for (int k = first[2]; k <= last[2]; ++k) stored += tile({i, j, k}).values != nullptr;
    }
  }
  return stored * sizeof(Values);
}

std::size_t DistanceField::memory_of_all() const {
  std::set<Block> candidates;
  for (TriangleId t = 0; t < index_->mesh().triangle_count(); ++t) {
    const auto [a, b, c] = index_->mesh().triangle(t);
    const auto block = [&](const Vec3& p) -> Eigen::Array3i {
      return (p / (side * cell_)).array().floor().cast<int>();
    };
    const Eigen::Array3i first = block(a.cwiseMin(b).cwiseMin(c) - Vec3::Constant(band_));
    const Eigen::Array3i last = block(a.cwiseMax(b).cwiseMax(c) + Vec3::Constant(band_));
    for (int i = first[0]; i <= last[0]; ++i) {
      for (int j = first[1]; j <= last[1]; ++j) {
        for (int k = first[2]; k <= last[2]; ++k) candidates.insert({i, j, k});
      }
    }
  }
  const auto near = [this](const Block& block) { return is_near(block); };
  return sizeof(Values) *
         static_cast<std::size_t>(std::count_if(candidates.begin(), candidates.end(), near));
}

double DistanceField::Reader::corner(int i, int j, int k) {
  const Block block{i >> 3, j >> 3, k >> 3};
  Entry& entry = last_[(block[0] & 1) | (block[1] & 1) << 1 | (block[2] & 1) << 2];
  if (!entry.tile || entry.block != block) entry = {block, &field_->tile(block)};
  const Tile& tile = *entry.tile;
  return tile.values ? (*tile.values)[((i & 7) * side + (j & 7)) * side + (k & 7)]
                     : tile.background;
}

DistanceField::Value DistanceField::Reader::operator()(const Vec3& point) {
  const double cell = field_->cell_;
  const Vec3 at = point / cell;
  const Vec3 base = at.array().floor();
  const Vec3 w = at - base;
  const auto [i, j, k] = std::array{int(base[0]), int(base[1]), int(base[2])};
  double c[2][2][2];
  for (int x = 0; x < 2; ++x) {
    for (int y = 0; y < 2; ++y) {
      for (int z = 0; z < 2; ++z) c[x][y][z] = corner(i + x, j + y, k + z);
    }
  }
  // Along z, then y, then x.
  double up[2][2], line[2][2], across[2], plane[2];
  for (int x = 0; x < 2; ++x) {
    for (int y = 0; y < 2; ++y) {
      up[x][y] = c[x][y][1] - c[x][y][0];
      line[x][y] = c[x][y][0] + w[2] * up[x][y];
    }
    across[x] = line[x][1] - line[x][0];
    plane[x] = line[x][0] + w[1] * across[x];
  }
  const double up_0 = up[0][0] + w[1] * (up[0][1] - up[0][0]);
  const double up_1 = up[1][0] + w[1] * (up[1][1] - up[1][0]);
  const double along = plane[1] - plane[0];
  return {
      plane[0] + w[0] * along,
      Vec3(along, across[0] + w[0] * (across[1] - across[0]), up_0 + w[0] * (up_1 - up_0)) / cell};
}

}  // namespace keepout::peers
