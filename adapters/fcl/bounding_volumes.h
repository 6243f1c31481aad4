// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcl/math/bv/AABB.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/math/bv/OBBRSS.h>

#include "keepout/geometry/ball_against_box.h"

namespace keepout {

/// Grows FCL's box until it holds the vertex.
inline void include(fcl::AABBd& box, const Vec3& vertex) {
  box.min_ = box.min_.cwiseMin(vertex);
  box.max_ = box.max_.cwiseMax(vertex);
}

inline void include(fcl::OBBd& box, const Vec3& vertex) {
  const Vec3 local = box.axis.transpose() * (vertex - box.To);
  box.extent = box.extent.cwiseMax(local.cwiseAbs());
}

/// Makes a box of what need not be one: an empty box around the vertex.
inline void start_anew(fcl::AABBd& box, const Vec3& vertex) { box = fcl::AABBd(vertex); }

inline void start_anew(fcl::OBBd& box, const Vec3& vertex) {
  box = fcl::OBBd(Eigen::Matrix3d::Identity(), vertex, Vec3::Zero());
}

/// Whether distances to the box mean what they say.
inline bool is_sound(const fcl::AABBd& box) { return box.min_.allFinite() && box.max_.allFinite(); }

/// Lengths in the frame of the box are those of the mesh, to the rounding that the radius is padded
/// by. FCL's axes are, unless the squares of the coordinates overflow.
inline bool is_sound(const fcl::OBBd& box) {
  const Eigen::Matrix3d gram = box.axis.transpose() * box.axis;
  const double skew = (gram - Eigen::Matrix3d::Identity()).cwiseAbs().sum();
  // Written so that a NaN fails.
  return skew <= 3e-14 && box.To.allFinite() && box.extent.allFinite();
}

inline double squared_distance(const fcl::AABBd& box, const Vec3& point) noexcept {
  return (box.min_ - point).cwiseMax(point - box.max_).cwiseMax(0.0).squaredNorm();
}

inline double squared_distance(const fcl::OBBd& box, const Vec3& point) noexcept {
  const Vec3 local = box.axis.transpose() * (point - box.To);
  return (local.cwiseAbs() - box.extent).cwiseMax(0.0).squaredNorm();
}

// Of an OBBRSS the box is used.
inline void include(fcl::OBBRSSd& volume, const Vec3& vertex) { include(volume.obb, vertex); }
inline void start_anew(fcl::OBBRSSd& volume, const Vec3& vertex) { start_anew(volume.obb, vertex); }
inline bool is_sound(const fcl::OBBRSSd& volume) { return is_sound(volume.obb); }
inline double squared_distance(const fcl::OBBRSSd& volume, const Vec3& point) noexcept {
  return squared_distance(volume.obb, point);
}

}  // namespace keepout
