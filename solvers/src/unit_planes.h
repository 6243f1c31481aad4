// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "active_set_tolerances.h"
#include "keepout/geometry/shapes.h"

namespace keepout::active_set {

/// A plane and how far a point is on its wrong side; none if there is no plane.
struct Violated {
  static constexpr int none = -1;
  int plane = none;
  double by = -std::numeric_limits<double>::infinity();
};

/// Sums in one order, which is that of the vector code as well.
inline double dot(const double* a, const double* b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double dot(const Vec3& a, const Vec3& b) noexcept { return dot(a.data(), b.data()); }

/// What a point misses of a plane n . u >= offset.
inline double missing(const double* normal, double offset, const double* point) noexcept {
  return offset - dot(normal, point);
}

/// Whether n . n is that of a unit vector, up to the rounding of whoever made it.
inline bool is_unit(double square) noexcept { return std::abs(square - 1.0) <= 1e-12; }

/// Planes with unit normals, coordinate by coordinate, to look for the one violated most.
class UnitPlanes {
 public:
  void reserve(std::size_t planes);

  void clear() noexcept { size_ = 0; }
  std::size_t size() const noexcept { return size_; }

  /// Precondition: fewer than reserved.
  void push(const double* normal, double offset) noexcept {
    x_[size_] = normal[0];
    y_[size_] = normal[1];
    z_[size_] = normal[2];
    offset_[size_] = offset;
    ++size_;
  }

  /// A place in the order that nothing violates.
  void push_idle() noexcept {
    constexpr double zero[3] = {};
    push(zero, -std::numeric_limits<double>::infinity());
  }

  /// Ends the list: to be called before it is looked through.
  void close() noexcept;

  /// The plane violated most, or least satisfied; of equals the first. The same bits on every
  /// target. Precondition: closed; the point is finite.
  Violated most_violated(const double* point) const noexcept;

 private:
  // The widest vector; the lists are filled up to whole ones.
  static constexpr std::size_t most_lanes = 8;

  std::size_t size_ = 0;
  std::vector<double> x_, y_, z_;
  std::vector<double> offset_;
};

}  // namespace keepout::active_set
