// SPDX-License-Identifier: BSD-3-Clause
//
// The report of a joint cycle: the limits and guides that kept a motion from being the commanded
// one.
#include "joint_cycle.h"

namespace keepout {

std::string_view InstrumentStep::reason() const noexcept {
  if (status == Status::free && limits.has(Limit::joints_outside)) {
    return "the motion is the one asked for, but a joint starts outside its position limits, where "
           "it may stay or come back: check q";
  }
  return keepout::reason(status, Subject::instrument);
}

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
  // If the budget ended, the obstacle is where the proof stopped, not what is in the way.
  if (judgement_.guide.knot < PointMotion::last_knot && !is_spent())
    note_guide(judgement_.guide.guide);
  for (const Certificate::Obstacle& obstacle : memory_.obstacles) {
    if (obstacle.triangle != nullptr) stopping_limits_.add(Limit::mesh);
  }
}

/// Notes the kind of limit of a search or a proof that the budget or the capacity ended.
void JointCycle::note_end(Status status) noexcept {
  if (status == Status::over_capacity) stopping_limits_.add(Limit::capacity);
  if (status == Status::out_of_budget) stopping_limits_.add(Limit::budget);
}

/// Reports which guides limit the motion, and which were relaxed. `is_cut`: the motion is not all
/// of the one that was asked for, or there is none.
void JointCycle::report_guides(const Trial& best, bool is_cut, InstrumentStep& result) noexcept {
  result.relaxation = best.relaxation;
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

/// Reports the limits that kept the motion from being the commanded one. `is_cut`: as above.
void JointCycle::report_limits(const Trial& best, bool is_cut, InstrumentStep& result) noexcept {
  const Status status = result.status;
  if (status == Status::free) return;
  Limits& limits = result.limits;
  if (status == Status::touching || status == Status::inside) limits.add(Limit::mesh);
  note_end(status);
  limits.add(best.limits);
  if (!is_cut) return;
  limits.add(stopping_limits_);
  if (is_ok(status)) limits.add(Limit::truncated);
}

}  // namespace keepout
