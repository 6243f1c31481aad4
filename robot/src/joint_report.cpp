// SPDX-License-Identifier: BSD-3-Clause
//
// The report of a joint cycle: the limits and guides that kept a motion from being the commanded
// one.
#include "joint_cycle.h"

namespace keepout {

/// Notes that a guide ended a search.
void JointCycle::note_guide(std::size_t guide) noexcept {
  stopping_limits_.add(Limit::guide);
  stopping_guides_.set(guide);
}

/// Notes the kinds of constraints that the last trial of a search could not be proved for. If the
/// rows contradict each other, notes the kinds of the rows.
void JointCycle::note_failure() noexcept {
  if (search_status_ == Status::ill_posed) return;
  if (search_status_ == Status::infeasible) {
    for (const Row& row : rows_.view()) {
      if (is_guide(row.owner)) {
        note_guide(guide_of(row.owner));
      } else {
        stopping_limits_.add(Limit::mesh);
      }
    }
    return;
  }
  // A proof that the budget ended says nothing about its subject.
  if (guide_obstacle_.knot < PointMotion::last_knot && !is_spent())
    note_guide(guide_obstacle_.guide);
  for (const Certificate::Obstacle& obstacle : memory_.obstacles) {
    if (obstacle.triangle != nullptr) stopping_limits_.add(Limit::mesh);
  }
}

/// Reports the limits that kept the motion from being the commanded one.
void JointCycle::report_limits(const Trial& best, InstrumentStep& result) noexcept {
  if (result.status == Status::free) return;
  Limits& limits = result.limits;
  const auto ended = [&](Status status) {
    return search_status_ == status || result.status == status;
  };
  if (result.status == Status::touching || result.status == Status::inside) limits.add(Limit::mesh);
  if (ended(Status::over_capacity)) limits.add(Limit::capacity);
  if (ended(Status::out_of_budget)) limits.add(Limit::budget);
  limits.add(best.limits);
  const bool is_cut = !is_ok(result.status) || is_shortened_ || best.fraction < 1.0;
  if (!is_cut) return;
  limits.add(stopping_limits_);
  if (is_ok(result.status)) limits.add(Limit::truncated);
}

/// Reports which guides limit the motion, and which were relaxed.
void JointCycle::report_guides(const Trial& best, InstrumentStep& result) noexcept {
  result.relaxation = best.relaxation;
  const bool is_cut = !is_ok(result.status) || is_shortened_ || best.fraction < 1.0;
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    GuideState& state = guides_.states()[g];
    state.limits = best.guides[g] || (is_cut && stopping_guides_[g]);
    state.relaxed =
        (best.relaxation != Relaxation::none && state.excess > 0.0) || guides_.is_dropped(g);
    if (guides_.is_dropped(g) && result.relaxation == Relaxation::none) {
      result.relaxation = Relaxation::guides;
    }
  }
}

}  // namespace keepout
