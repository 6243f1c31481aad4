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

/// A view of the caller's own rows: linear constraints A u >= b of the increment u, such as joint
/// limits.
class ExtraRows {
 public:
  /// Makes a view. `matrix`: A (m, n), row by row. `bounds`: b (m). Both must outlive the step.
  ExtraRows(const double* matrix, const double* bounds, Eigen::Index count) noexcept
      : matrix_(matrix), bounds_(bounds), count_(count) {}

  /// Returns the number of rows, m.
  Eigen::Index count() const noexcept { return count_; }
  /// Returns A (m, n), row by row.
  const double* matrix() const noexcept { return matrix_; }
  /// Returns b (m).
  const double* bounds() const noexcept { return bounds_; }

 private:
  const double* matrix_;
  const double* bounds_;
  Eigen::Index count_;
};

/// The request for a motion: the input of a control cycle. The resulting motion of the tip is
/// Step::motion.
struct Motion {
  Vec3 tip = unset;      // commanded tip, in the frame of the mesh [length]
  Vec3 desired = unset;  // desired increment [length]
  /// The Jacobian of the joints that move the tip, a 3 x n matrix. With more than three joints, or
  /// joints that move the tip in the same direction, the step needs StepOptions::damping above 0.
  /// Without a Jacobian the tip itself moves: u = dx.
  std::optional<TipJacobian> jacobian = std::nullopt;
  /// Further linear constraints of the increment. A bound above 0 demands motion.
  std::optional<ExtraRows> rows = std::nullopt;

  /// The value of a member that is not set. A step with an unset member returns invalid_input.
  inline static const Vec3 unset = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// The result of one control cycle. Views stay valid until the next step of the same
/// MotionConstraint, or until its options are set.
struct Step {
  Status status = Status::invalid_input;   // the outcome of the step
  Vec3 motion = Vec3::Zero();              // of the tip; zero unless ok() [length]
  std::span<const double> increment = {};  // u: of the tip or the joints (n); empty unless ok()
  /// All planes of the last solve: those of the mesh, then those of guides. The source is
  /// no_triangle for planes of guides, and for planes that limit the motion to the motion sphere. A
  /// rule may leave out planes that cannot change the result: see RuleInput::is_projected.
  std::span<const HalfSpace> planes = {};
  /// The indices of the planes that limit the motion; those from planes.size() on are extra rows.
  /// Empty unless ok().
  std::span<const std::uint32_t> active = {};
  /// The limits that make the motion differ from the desired increment. Without a motion: the
  /// causes why no motion was found, such as constraints that cannot be satisfied together.
  Limits limits = {};
  std::span<const GuideState> guides = {};   // one for each guide, in the order of set_guides
  Relaxation relaxation = Relaxation::none;  // the constraints that were relaxed
  /// The number of triangles that the result depends on: see ActivationRule::triangles.
  std::size_t triangles = 0;
  /// The distance from the tip at the start of the step to the nearest triangle, on either side
  /// [length]. The certified rule knows it for a tip within the required clearance, and for an
  /// escape. For other tips, the step measures it only with the option Distances::always, and
  /// spends only the remaining work units. Empty if unknown: for invalid_input and mesh_changed,
  /// and possibly for out_of_budget. Bitwise identical on every index.
  std::optional<double> distance = std::nullopt;

  /// Returns true if there is a motion that may be executed; it may be zero.
  bool ok() const noexcept { return is_ok(status); }
  /// Returns one line on what happened and what to do about it; a string literal.
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::tip); }
};

/// The time of each stage of a cycle. Stages that a step does not reach are zero; in an escape, all
/// are zero. [ns]
struct StageTimes {
  std::int64_t query = 0;  // the rule gathers triangles: a query, or the beginning of a traversal
  std::int64_t activation = 0;  // the rule measures the tip; it may traverse along the target
  std::int64_t solve = 0;       // solve, judge, cut and refine; may traverse along each trial;
                                // also the time of a monitor

  /// Returns the time of all stages. [ns]
  std::int64_t total() const noexcept { return query + activation + solve; }
};

}  // namespace keepout
