// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "keepout/geometry/shapes.h"
#include "keepout/status.h"
#include "keepout/step/guide.h"
#include "keepout/step/tip_jacobian.h"

namespace keepout {

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
  /// Of the joints that are to move the tip: a 3 x n matrix of Eigen's. With more than three
  /// joints, or such as move the tip alike, it needs StepOptions::damping above 0. Without a
  /// Jacobian the tip itself is what moves: u = dx.
  std::optional<TipJacobian> jacobian = std::nullopt;
  /// What else the increment must satisfy. Bounds above 0 ask for motion.
  std::optional<ExtraRows> rows = std::nullopt;

  /// What was forgotten is refused, not guessed.
  inline static const Vec3 unset = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// What one control cycle may do. Views stay valid until the next step of the same
/// MotionConstraint, or until its options are set.
struct Step {
  Status status = Status::invalid_input;   // how it ended
  Vec3 motion = Vec3::Zero();              // of the tip; zero unless ok() [length]
  std::span<const double> increment = {};  // u: the tip's, or the joints' (n); empty unless ok()
  /// All that were posed to the solver: those of the mesh, then those of guides, whose source is
  /// no_triangle. A rule may leave out those on which the answer cannot depend: see
  /// CycleProblem::is_projected.
  std::span<const HalfSpace> planes = {};
  /// The planes that limit the motion; empty unless ok(). From planes.size() on, extra rows.
  std::span<const std::uint32_t> active = {};
  /// The causes that kept the motion from being the commanded one; without a motion, the
  /// constraints for which none was found.
  Limits limits = {};
  std::span<const GuideState> guides = {};   // one for each guide, in the order of set_guides
  Relaxation relaxation = Relaxation::none;  // what was relaxed
  std::size_t triangles = 0;                 // that it rests on: see ActivationRule::triangles
  /// From the tip, where it was as the step began, to the nearest triangle, on whichever side. Told
  /// where it is known anyway, which is under the certified rule, of a tip no farther off than the
  /// distance kept, or one that is led out from inside; and of every other tip if
  /// StepOptions::distances says so. Empty where it is not known, and for input that is invalid.
  /// The same on every index, bit for bit. [length]
  std::optional<double> distance = std::nullopt;

  /// Whether there is a motion that may be carried out; it may be zero.
  bool ok() const noexcept { return is_ok(status); }
  /// One line on what happened and what to do about it; a literal.
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::tip); }
};

/// The time that each part of a step took, to know them apart. What a failed step does not reach
/// stays at zero. [ns]
struct StageTimes {
  std::int64_t query = 0;       // the index is asked what is around; of a walk, its beginning
  std::int64_t activation = 0;  // the rule begins
  std::int64_t solve = 0;       // trials are solved and judged

  /// Of all stages. [ns]
  std::int64_t total() const noexcept { return query + activation + solve; }
};

}  // namespace keepout
