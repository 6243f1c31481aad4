// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>

#include "keepout/geometry/half_space.h"
#include "keepout/geometry/vec3.h"
#include "keepout/step/status.h"

namespace keepout {

/// A view of the tip's Jacobian J, dx = J dq: 3 x n, column by column. [length / unit of the joint]
class TipJacobian {
 public:
  /// 3 rows, a column for each joint.
  using Matrix = Eigen::Matrix<double, 3, Eigen::Dynamic>;

  /// The matrix must outlive the step.
  TipJacobian(const Matrix& matrix) noexcept : data_(matrix.data()), joints_(matrix.cols()) {}
  TipJacobian(Matrix&&) = delete;
  /// `data`: 3 `joints` numbers, column by column, which must outlive the step.
  TipJacobian(const double* data, Eigen::Index joints) noexcept : data_(data), joints_(joints) {}

  /// How many columns there are.
  Eigen::Index joints() const noexcept { return joints_; }
  /// Its numbers, column by column.
  const double* data() const noexcept { return data_; }
  /// J (3, n), as a view.
  Eigen::Map<const Matrix> matrix() const noexcept { return {data_, 3, joints_}; }

 private:
  const double* data_;
  Eigen::Index joints_;
};

/// A view of rows of the caller's own on the increment u, such as joint limits: A u >= b.
class ExtraRows {
 public:
  /// `matrix`: A (m, n), row by row. `bounds`: b (m). Both must outlive the step.
  ExtraRows(const double* matrix, const double* bounds, Eigen::Index count) noexcept
      : matrix_(matrix), bounds_(bounds), count_(count) {}

  /// How many rows there are, m.
  Eigen::Index count() const noexcept { return count_; }
  /// A (m, n), row by row.
  const double* matrix() const noexcept { return matrix_; }
  /// b (m).
  const double* bounds() const noexcept { return bounds_; }

 private:
  const double* matrix_;
  const double* bounds_;
  Eigen::Index count_;
};

/// What is asked of one control cycle.
struct Motion {
  Vec3 tip = unset;      // in the frame of the mesh [length]
  Vec3 desired = unset;  // increment asked for [length]
  /// Of the joints that are to move the tip. Without one, the tip itself is what moves: u = dx.
  std::optional<TipJacobian> jacobian = std::nullopt;
  /// What else the increment must satisfy. Bounds above 0 ask for motion.
  std::optional<ExtraRows> rows = std::nullopt;

  /// What was forgotten is refused, not guessed.
  inline static const Vec3 unset = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// What one control cycle may do. Views stay valid until the next step of the same workspace.
struct Step {
  Status status = Status::invalid_input;  // how it ended
  Vec3 motion = Vec3::Zero();             // of the tip; zero unless ok() [length]
  std::span<const double> increment;      // u: the tip's, or the joints' (n); empty unless ok()
  /// All that were posed to the solver. A rule that searches an index by itself may leave out those
  /// that no motion in question comes near: see NeededPlanes.
  std::span<const HalfSpace> planes;
  /// Which of them hold the motion back; empty unless ok(). From planes.size() on, extra rows.
  std::span<const std::uint32_t> active;
  std::size_t triangles = 0;  // that it rests on: see Activation::triangles

  /// Whether there is a motion that may be carried out; it may be zero.
  bool ok() const noexcept { return is_ok(status); }
  /// One line on what happened and what to do about it; a literal.
  std::string_view reason() const noexcept { return keepout::reason(status); }
};

}  // namespace keepout
