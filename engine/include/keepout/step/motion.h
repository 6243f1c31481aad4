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

/// Not a motion of the tip, which is a Vec3, but the request for one: the input of a control cycle.
struct Motion {
  Vec3 tip = unset;      // commanded tip, in the frame of the mesh [length]
  Vec3 desired = unset;  // desired increment [length]
  /// The Jacobian of the joints that move the tip, a 3 x n matrix. With more than three joints, or
  /// joints that move the tip in the same direction, it needs StepOptions::damping above 0. Without
  /// a Jacobian the tip itself moves: u = dx.
  std::optional<TipJacobian> jacobian = std::nullopt;
  /// Further constraints of the increment. Bounds above 0 demand motion.
  std::optional<ExtraRows> rows = std::nullopt;

  /// A request without a tip or an increment is refused: invalid_input.
  inline static const Vec3 unset = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// The result of one control cycle. Views stay valid until the next step of the same
/// MotionConstraint, or until its options are set.
struct Step {
  Status status = Status::invalid_input;   // how it ended
  Vec3 motion = Vec3::Zero();              // of the tip; zero unless ok() [length]
  std::span<const double> increment = {};  // u: the tip's, or the joints' (n); empty unless ok()
  /// All planes that the solver got: those of the mesh, then those of guides. The source is
  /// no_triangle for a guide, and also for a plane among those of the mesh that bounds the motion
  /// to the motion sphere.
  /// A rule may leave out planes on which the answer cannot depend: see RuleInput::is_projected.
  std::span<const HalfSpace> planes = {};
  /// The planes that limit the motion; empty unless ok(). From planes.size() on, extra rows.
  std::span<const std::uint32_t> active = {};
  /// The causes why the motion is not the desired increment; without a motion, the constraints for
  /// which none was found.
  Limits limits = {};
  std::span<const GuideState> guides = {};   // one for each guide, in the order of set_guides
  Relaxation relaxation = Relaxation::none;  // what was relaxed
  std::size_t triangles = 0;  // examinations that it rests on: see ActivationRule::triangles
  /// From the tip at the start of the step to the nearest triangle, on either side. Known at no
  /// cost under the certified rule, for a tip within the required clearance, and for an escape; for
  /// every other tip it is searched if StepOptions::distances says so, with the work units that are
  /// left. Empty if unknown, as it may be for out_of_budget, and for invalid_input and
  /// mesh_changed. Bitwise identical on every index. [length]
  std::optional<double> distance = std::nullopt;

  /// Whether there is a motion that may be carried out; it may be zero.
  bool ok() const noexcept { return is_ok(status); }
  /// One line on what happened and what to do about it; a literal.
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::tip); }
};

/// The time of each stage of a cycle. Stages that a step does not reach stay at zero: all of them
/// in an escape. [ns]
struct StageTimes {
  std::int64_t query = 0;  // the rule gathers triangles: a query, or the beginning of a traversal
  std::int64_t activation = 0;  // the rule opens the cycle; may traverse along the target
  std::int64_t solve = 0;       // solve, judge, cut and refine; may traverse along each trial

  /// Returns the time of all stages. [ns]
  std::int64_t total() const noexcept { return query + activation + solve; }
};

}  // namespace keepout
