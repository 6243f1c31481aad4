// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "active_set_tolerances.h"
#include "keepout/geometry/shapes.h"

namespace keepout::active_set {

/// The number in place of a row or plane that does not exist.
inline constexpr int no_row = -1;

/// A row or plane, and the distance of a point on its wrong side; no_row without one.
struct Violated {
  int row = no_row;
  double by = -std::numeric_limits<double>::infinity();
};

/// Adds in the same order as the vector code.
inline double dot(const double* a, const double* b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double dot(const Vec3& a, const Vec3& b) noexcept { return dot(a.data(), b.data()); }

/// Returns the violation of a plane n . u >= offset by a point.
inline double missing(const double* normal, double offset, const double* point) noexcept {
  return offset - dot(normal, point);
}

/// Returns true if n . n is that of a unit vector, up to rounding.
inline bool is_unit(double square) noexcept { return std::abs(square - 1.0) <= 1e-12; }

inline bool is_unit_in_range(const HalfSpace& plane) noexcept {
  return is_unit(dot(plane.normal, plane.normal)) && std::abs(plane.offset) <= largest;
}

/// Planes with unit normals, coordinate by coordinate, to find the one that is violated most.
class UnitPlanes {
 public:
  void reserve(std::size_t planes);

  void clear() noexcept { size_ = 0; }

  /// Replaces the list. Returns true if all normals are unit vectors and all offsets in range.
  bool assign(std::span<const HalfSpace> planes) noexcept {
    clear();
    bool usable = true;
    for (const HalfSpace& plane : planes) {
      usable &= is_unit_in_range(plane);
      push(plane.normal.data(), plane.offset);
    }
    return usable;
  }

  /// Adds a plane. Precondition: the reserve is not full.
  void push(const double* normal, double offset) noexcept {
    x_[size_] = normal[0];
    y_[size_] = normal[1];
    z_[size_] = normal[2];
    offset_[size_] = offset;
    ++size_;
  }

  /// Ends the list. Must be called before most_violated().
  void close() noexcept;

  /// Returns the plane that is violated most, or satisfied least; the first of equals. Bitwise
  /// identical on every target. Precondition: closed; the point is finite.
  Violated most_violated(const double* point) const noexcept;

 private:
  // The most lanes of a vector. The lists are filled up to whole vectors.
  static constexpr std::size_t most_lanes = 8;

  std::size_t size_ = 0;
  std::vector<double> x_, y_, z_;
  std::vector<double> offset_;
};

}  // namespace keepout::active_set
